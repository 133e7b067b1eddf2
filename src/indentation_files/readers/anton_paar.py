"""Anton Paar (CSM) indentation exports ``.TXT``: one test with a header of settings and results."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.anton_paar_columns import HEADING, NAMES, key_of
from indentation_files.readers.numbers_in_text import column, number, refuse_unlike, require_tabs, table
from indentation_files.readers.source import Source
from indentation_files.readers.units import CHANNELS, scale
from indentation_files.readers.vendor import Reader, VendorTest, unfinished, usable, vendor_test

BRACKET = re.compile(r"[\[({<]")  # before each unit
LARGEST = {"load": "Fmax", "depth": "hmax"}  # among the results above the values
SHORT = 0.02  # of these
TWICE = 2.0  # of these: what is beyond is in another unit
UNITS_APART = 100.0  # so is what falls short by more, chosen


def matches(source: Source) -> bool:
    """Return whether the file begins with the word Indentation, or a later line is of a test's headings."""
    return source.first.startswith("Indentation") or (
        len(columns(source.first)) < len(NAMES) and _header(source) is not None
    )


def _header(source: Source) -> int | None:
    """Return the line that names all channels, each with its unit; None where there is none."""
    bracketed = ((k, line) for k, line in source.lines.in_words() if BRACKET.search(line))
    return next((k for k, line in bracketed if len(columns(line)) == len(NAMES)), None)


def read(source: Source) -> list[VendorTest]:
    """Read the one test of the file; depth and load are the vendor's, from contact on."""
    lines, start = source.lines, _header(source)
    if start is None:
        for _, line in lines.in_words():
            if all(re.search(rf"\b({'|'.join(names)}) *[(\[]", line) for names in NAMES.values()):
                require_tabs(line)
        remedy = "export the test again, with data, or name its columns (--columns time=...,load=...,depth=...)"
        raise InputError("lacks its column line, such as Time (s), Pd (nm), Fn (mN)", remedy=remedy)
    places = columns(lines[start])
    values = table(lines[start + 1 :], len(lines[start].rstrip().split("\t")))
    refuse_unlike(lines[start], columns, values)
    channels = [column(values, places[key][0], scale(key, places[key][1])) for key in NAMES]
    kept, warnings = usable("measured values", *channels)
    time, load, depth = (channel[kept] for channel in channels)
    facts = metadata(lines[:start])
    messages = (*warnings, *unlike_stated(load, depth, facts), *unfinished(load))
    return [vendor_test(source, source.path.stem, (time, load, depth), facts, messages)]


def unlike_stated(load: np.ndarray, depth: np.ndarray, facts: Mapping[str, str]) -> tuple[str, ...]:
    """Return a warning for each of load and depth whose largest value falls short of the file's own, or is far beyond.

    The `facts` hold these under the names of `LARGEST`, each with its unit.
    """
    messages = []
    for key, values in (("load", load), ("depth", depth)):
        name = LARGEST[key]
        with suppress(InputError, ValueError, ZeroDivisionError):
            value, unit = facts.get(name, "").rsplit(maxsplit=1)
            share = values.max() / (number(value) * scale(key, unit))
            if share < 1 - SHORT or share > TWICE:
                found = f"the largest {key} is {values.max():.4g} {CHANNELS[key]}"
                odd = "the file may be cut off" if 1 / UNITS_APART < share < 1 else "one of the units may be wrong"
                messages.append(f"{found}, the file states {name} = {facts[name]}; {odd}")
    return tuple(messages)


def columns(line: str) -> dict[str, tuple[int, str]]:
    """Return the place and the unit of each channel that a line of headings such as ``Pd (nm)`` names."""
    headings = enumerate(map(HEADING.fullmatch, map(str.strip, line.split("\t"))))
    return {key_of(found): (place, found[3]) for place, found in headings if found and not found[1]}


def metadata(lines: Iterable[str]) -> dict[str, str]:
    """Return the header's entries ``name : value`` and ``name= value`` as text."""
    entries = {}
    for line in lines:
        found = re.match(r"\s*([^:=]+?)\s*[:=]\s*(.*\S)", line)
        if found:
            entries[found[1]] = " ".join(found[2].split())
    return entries


READER = Reader("anton_paar", "Anton Paar indentation export", matches, read)
