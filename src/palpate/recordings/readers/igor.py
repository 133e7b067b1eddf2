"""How often an Igor binary wave of an Asylum Research microscope was sampled: it holds no column of times.

The wave scales its points by time (Igor's "x scaling"), and the note that the microscope writes into it gives the rate,
``NumPtsPerSec``.
"""

from __future__ import annotations

import io
import re

from palpate.errors import InputError

VERSIONS = (b"\x05\x00", b"\x00\x05", b"\x02\x00", b"\x00\x02")  # little and big end first
OF_CANTILEVER = (b"SpringConstant", b"InvOLS", b"NumPtsPerSec")
RATE = re.compile(rb"[\r\n]NumPtsPerSec:\s*(\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)")
ALIKE = 0.01  # of the step: scaling and rate that differ less are one


def is_wave(content: bytes) -> bool:
    """Return whether bytes are an Igor binary wave with a note on a cantilever."""
    return content.startswith(VERSIONS) and any(word in content for word in OF_CANTILEVER)


def sampling(content: bytes) -> tuple[float, tuple[str, ...]]:
    """Return the time between two points of a wave [s], and what the user should know of it.

    Raises
    ------
    InputError
        When neither the scaling nor the note gives it.
    """
    stated = RATE.search(content)
    by_rate = 1.0 / float(stated[1]) if stated and float(stated[1]) > 0 else 0.0
    by_scaling = _scaling(content)
    if by_scaling and by_rate and abs(by_scaling - by_rate) > ALIKE * by_rate:
        between = f"the wave's scaling says {by_scaling:.4g} s between points, its NumPtsPerSec {by_rate:.4g} s"
        return by_scaling, (f"{between}; the former is taken",)
    if not by_scaling and not by_rate:
        raise InputError("states neither NumPtsPerSec nor a scaling in seconds", remedy="export it with time, as text")
    return by_rate or by_scaling, ()


def _scaling(content: bytes) -> float:
    """Return the step of the wave's first dimension [s]; zero where it is no time."""
    from igor2 import binarywave

    header = binarywave.load(io.BytesIO(content))["wave"]["wave_header"]
    if "sfA" in header:
        unit = b"".join(header["dimUnits"][0])
        step = float(header["sfA"][0])
    else:
        unit, step = b"".join(header["xUnits"]), float(header["hsA"])
    return step if unit.strip(b"\0 ") == b"s" and step > 0 else 0.0
