"""How often an Igor binary wave of an Asylum Research microscope was sampled: it holds no column of times.

The wave scales its points by time (Igor's "x scaling"), and the note that the microscope writes into it gives the rate,
``NumPtsPerSec``.
"""

from __future__ import annotations

import io
import re

import numpy as np

from indentation_files.errors import InputError

OF_CANTILEVER = (b"SpringConstant", b"InvOLS", b"NumPtsPerSec")
NUMBER = rb":\s*(\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)"
HEADERS = {b"\x05\x00": ("<", 384), b"\x00\x05": (">", 384), b"\x02\x00": ("<", 126), b"\x00\x02": (">", 126)}  # bytes
ALIKE = 0.01  # of the step: scaling and rate that differ less are one


def is_wave(content: bytes) -> bool:
    """Return whether bytes are an Igor binary wave with a note on a cantilever."""
    return content.startswith(tuple(HEADERS)) and any(word in content for word in OF_CANTILEVER)


def may_be_wave(content: bytes) -> bool:
    """Return whether bytes begin as any Igor binary wave: the 16-bit words of its headers add up to zero."""
    order, size = HEADERS.get(content[:2], ("<", 0))
    if not size or len(content) < size:
        return False
    return int(np.frombuffer(content[:size], dtype=f"{order}i2").sum(dtype=np.int64)) % 65536 == 0


def stated(content: bytes, key: bytes) -> float:
    """Return the number that the note gives under `key`; zero where it gives none."""
    found = re.search(rb"[\r\n\0]" + key + NUMBER, content)
    return float(found[1]) if found else 0.0


def sampling(content: bytes) -> tuple[float, tuple[str, ...]]:
    """Return the time between two points [s], and what the user should know of it; raises `InputError` without it."""
    rate = stated(content, b"NumPtsPerSec")
    by_rate = 1.0 / rate if rate else 0.0
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
