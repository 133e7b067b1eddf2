"""Optics11 (Piuma, Chiaro, Pavone) exports: a piezo moves a cantilever whose bending is the load.

The column Indentation is piezo less cantilever, counted from the contact that the instrument found, and zero before it.
A file whose instrument found none counts it from its first point. The two columns give the depth before contact too::

    depth = piezo - cantilever - (its value at the instrument's contact)
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import numpy as np

from indentation_files.readers.numbers_in_text import column, refuse_unlike, table
from indentation_files.readers.source import Source
from indentation_files.readers.units import scale
from indentation_files.readers.vendor import Reader, VendorTest, unfinished, usable, vendor_test

COLUMNS = {"Time": "time", "Load": "load", "Indentation": "depth", "Cantilever": "depth", "Piezo": "depth"}
HEADING = re.compile(r"\s*(\w+)\s*[(\[](.+)[)\]]\s*")
DEEP = 0.1  # of the largest indentation: only what leads there is the contact
LEVEL = 10  # points that give the load without contact


def matches(source: Source) -> bool:
    """Return whether a line names the columns of piezo and cantilever."""
    return next(_headings(source), None) is not None


def _headings(source: Source) -> Iterator[tuple[int, dict[str, tuple[int, str]]]]:
    """Yield each line that names all columns, by its number, and what it names."""
    for number, line in source.lines.in_words():
        if "piezo" in line.casefold() and {*COLUMNS} <= {*(named := columns(line))}:
            yield number, named


def columns(line: str) -> dict[str, tuple[int, str]]:
    """Return the place and the unit of each column that a line of headings such as ``Piezo (nm)`` names."""
    headings = enumerate(map(HEADING.fullmatch, line.split("\t")))
    return {found[1].capitalize(): (place, found[2]) for place, found in headings if found}


def read(source: Source) -> list[VendorTest]:
    """Read the one test; time is counted from the instrument's contact, load from what the cantilever shows there."""
    lines = source.lines
    start, places = next(_headings(source))
    values = table(lines[start + 1 :], len(lines[start].rstrip().split("\t")))
    refuse_unlike(lines[start], columns, values)
    channels = [column(values, places[name][0], scale(key, places[name][1])) for name, key in COLUMNS.items()]
    kept, warnings = usable("measured values", *channels)
    time, load, indentation, cantilever, piezo = (channel[kept] for channel in channels)
    depth = piezo - cantilever
    begin, zero, marked = 0, float(depth[0]), _marked(indentation)
    if marked:
        begin, zero = _last_free(indentation), float(np.median((depth - indentation)[indentation > 0]))
    load = load - float(np.median(load[max(begin - LEVEL, 0) : begin + 1]))
    channels, facts = [time - time[begin], load, depth - zero], metadata(lines[:start])
    return [vendor_test(source, source.path.stem, channels, facts, (*warnings, *unfinished(load)), marked=marked)]


def _marked(indentation: np.ndarray) -> bool:
    """Return whether the column gives contact: it is zero before it, or negative from far before it on.

    A first point alone is no approach: the column may count from where the file begins.
    """
    largest = float(indentation.max())
    before = indentation[: _last_free(indentation) + 1]
    return largest > 0.0 and len(before) > 1 and bool(before[-1] == 0.0 or before.min() < -DEEP * largest)


def _last_free(indentation: np.ndarray) -> int:
    """Return the last point that is not pressed before the tip goes deep."""
    deep = int(np.argmax(indentation > DEEP * indentation.max()))
    return max([0, *np.flatnonzero(indentation[:deep] <= 0)])


def metadata(lines: Iterable[str]) -> dict[str, str]:
    """Return the header's entries, ``name<tab>value`` (several on a line) or ``name: value``, as text."""
    entries: dict[str, str] = {}
    for line in lines:
        cells = [cell.strip(" :") for cell in re.split(r"\t|: ", line)]
        entries |= {name: value for name, value in zip(cells[::2], cells[1::2], strict=False) if name and value}
    return entries


READER = Reader("optics11", "Optics11 Piuma, Chiaro or Pavone export", matches, read)
