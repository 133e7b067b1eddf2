"""Fischer (Fischerscope HM, Picodentor) measurements as HDF5: a group for each test, channels with their units.

So the converter of the project micromechanics writes the instrument's binary ``.hap``. Other makers' files of the same
layout are none of Fischer's, and their depths and loads may be raw.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping, Sequence

import numpy as np

from indentation_files.bounded_process import read_hdf5
from indentation_files.errors import InputError
from indentation_files.readers.several_tests import Part, parted
from indentation_files.readers.source import HDF5, Source
from indentation_files.readers.units import SCALES, unit_of
from indentation_files.readers.vendor import (
    Reader,
    Unreadable,
    VendorTest,
    read_or_report,
    unfinished,
    usable,
    vendor_test,
)
from indentation_files.sentences import first_few

NAMES = {"time": ("time",), "load": ("force", "load"), "depth": ("displacement", "depth")}
FACTS = ("", "instrument", "metadata")
WRITERS = (b"hap2hdf", b"WIN-HCU", b"Fischer", b"FISCHER")
OTHER_WRITERS = (b"Micromaterials2hdf", b"nmd2hdf", b"xls2hdf", b"afmformats")
Columns = Mapping[str, tuple[Sequence[float], Mapping[str, str]]]
APPROACH = 0.05  # of the largest load: what stays below it before the clock begins anew is the search for the surface


def matches(source: Source) -> bool:
    """Return whether the file is HDF5 and names Fischer's program, and no other's converter."""
    if not source.begun.startswith(HDF5):
        return False
    content = source.content
    return any(name in content for name in WRITERS) and not any(name in content for name in OTHER_WRITERS)


def read(source: Source) -> list[VendorTest | Unreadable]:
    """Read all tests; raises `InputError` when the library h5py is missing, or no test can be read."""
    if importlib.util.find_spec("h5py") is None:
        raise InputError("Fischer's HDF5 needs the library h5py", remedy="install it: pip install h5py")
    found = read_hdf5(source.content)
    if found.problem:
        raise InputError(f"h5py cannot read it ({found.problem})", remedy="copy or export it again")
    facts = {key: value for name in FACTS for key, value in found.attributes.get(name, {}).items()}
    groups = sorted(found.groups.items(), key=lambda item: _numbered(item[0]))
    return [test for path, group in groups if _channels(group) for test in _of_group(source, path, group, facts)]


def _numbered(path: str) -> list[tuple[int, str]]:
    """Return a path as a key by which test_2 comes before test_10; HDF5 keeps groups by their letters."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path)]


def _channels(group: Columns) -> dict[str, str]:
    """Return what a group calls its channels; empty where it lacks one."""
    spelt = {name.casefold(): name for name in group}
    found = {key: next((spelt[name] for name in names if name in spelt), "") for key, names in NAMES.items()}
    return found if all(found.values()) else {}


def _of_group(source: Source, path: str, group: Columns, facts: dict[str, str]) -> list[VendorTest | Unreadable]:
    """Return the tests in a group: one, or as many as its clock begins anew and the load rises again."""
    name = " ".join(part for part in path.split("/") if part not in ("", "data")) or source.path.stem
    channels = read_or_report(source.path, name, _values, group)
    if isinstance(channels, Unreadable):
        return [Unreadable(name, channels.error)]

    def point(*rows: int) -> str:
        return f"point {first_few([row + 1 for row in rows])}"

    parts = parted(channels, np.zeros(len(channels[0]), dtype=bool), point)
    peaks = [float(part.channels[1].max()) for part in parts]
    pressed = [part for part, peak in zip(parts, peaks, strict=True) if peak > APPROACH * max(peaks)]
    unpressed = len(parts) - len(pressed)
    before = (f"{unpressed} parts without load before the clock begins anew left out",) if unpressed else ()
    tests: list[VendorTest | Unreadable] = []
    for number, part in enumerate(pressed, 1):
        called = f"{name} {number}" if len(pressed) > 1 else name
        tests.append(read_or_report(source.path, called, _test, source, called, part, facts, before))
    return tests


def _values(group: Columns) -> list[np.ndarray]:
    """Return time [s], load [mN] and depth [nm] of a group, each of shape (n,)."""
    columns = []
    for key, name in _channels(group).items():
        data, attributes = group[name]
        stated = next((value for called, value in attributes.items() if called.casefold() in ("unit", "units")), "")
        unit = unit_of(key, stated)
        if unit is None:
            raise InputError(
                f"its {name} is in {stated!r}" if stated else f"states no unit of its {name}",
                remedy=f"convert it again with one of: {', '.join(SCALES[key])}, or export the tests as text",
            )
        columns.append(SCALES[key][unit] * np.asarray(data, dtype=float))
    if len({len(column) for column in columns}) > 1:
        raise InputError("its channels are of unequal length", remedy="convert it again, or export the tests as text")
    return columns


def _test(source: Source, name: str, part: Part, facts: dict[str, str], before: tuple[str, ...]) -> VendorTest:
    """Return the test of a name from its part of a group, with messages on what comes before it."""
    kept, warnings = usable(name, *part.channels)
    time, load, depth = (channel[kept] for channel in part.channels)
    messages = (*part.messages, *before, *warnings, *unfinished(load))
    return vendor_test(source, name, (time - time[0], load, depth), facts, messages)


READER = Reader("fischer_hdf5", "Fischer HDF5 (by h5py)", matches, read)
