"""Fischer (Fischerscope HM, Picodentor) text exports: all tests of one or more series, one below another."""

from __future__ import annotations

import re
from itertools import pairwise

from indentation_files.errors import InputError
from indentation_files.readers.anton_paar import LARGEST, metadata, unlike_stated
from indentation_files.readers.lines import Lines
from indentation_files.readers.numbers_in_text import table
from indentation_files.readers.source import Source
from indentation_files.readers.units import SCALES
from indentation_files.readers.vendor import (
    Reader,
    Unreadable,
    VendorTest,
    read_or_report,
    unfinished,
    usable,
    vendor_test,
)

APPLICATION = "\tName of the application"
COLUMNS = ["F", "h", "t"]
BLOCK = re.compile(r"Block\s*:\s*(\d+)\s+Value\s*:\s*(\d+)")
UNIT_OF_DEPTH = "um"


def matches(source: Source) -> bool:
    """Return whether the first line names the application."""
    return source.first.endswith(APPLICATION)


def read(source: Source) -> list[VendorTest | Unreadable]:
    """Read all tests; each begins with a line of the application's name and the date.

    The file states no unit for its columns F, h and t; they are mN, um and s, as the largest load and depth show that
    are written above them with theirs. Where these differ, a warning says so.
    """
    lines = source.lines
    begins = [k for k, line in lines.in_words() if line.rstrip().endswith(APPLICATION)]
    series = [lines[begin:end] for begin, end in pairwise([*begins, len(lines)])]
    return [test for one in series for test in _series(source, one, len(series) > 1)]


def _series(source: Source, lines: Lines, several: bool) -> list[VendorTest | Unreadable]:
    """Return the tests of the series on the `lines`, of one of `several` under its name."""
    application = lines[0].rstrip().removesuffix(APPLICATION).strip()
    dated = re.compile(rf"{re.escape(application)}\s+\d+[./-]\d+[./-]\d+\s+\d+:\d+")
    starts = [k for k, line in lines.in_words() if dated.match(line)]
    program, tests = metadata(lines[: starts[0]]) if starts else {}, []
    for number, (start, stop) in enumerate(pairwise([*starts, len(lines)]), 1):
        found = next(filter(None, (BLOCK.match(line) for _, line in lines[start:stop].in_words())), None)
        name = f"Block {found[1]} Value {found[2]}" if found else f"Test {number}"
        name = f"{application} {name}" if several else name
        tests.append(read_or_report(source.path, name, _test, source, name, lines[start:stop], program))
    return tests


def _test(source: Source, name: str, lines: Lines, program: dict[str, str]) -> VendorTest:
    """Return the test on the `lines`, with the series' `program` among its facts."""
    header = next((k for k, line in lines.in_words() if line.split("\t")[: len(COLUMNS)] == COLUMNS), None)
    if header is None:
        raise InputError(f"lacks its line of columns {', '.join(COLUMNS)}", remedy="export the test again, with data")
    load, depth, time = table(lines[header + 1 :], len(COLUMNS)).T
    kept, warnings = usable(name, time, load, depth)
    load, depth = load[kept], depth[kept] * SCALES["depth"][UNIT_OF_DEPTH]
    entries = [[cell.strip() for cell in line.split("\t")] for line in lines[:header]]
    results = {f"{entry[0]} {entry[1]}": entry[2] for entry in entries if len(entry) > 2}
    facts = program | {"test": lines[0].strip()} | results
    messages = (*warnings, *unlike_stated(load, depth, _largest(results, program)), *unfinished(load))
    return vendor_test(source, name, (time[kept], load, depth), facts, messages)


def _largest(results: dict[str, str], program: dict[str, str]) -> dict[str, str]:
    """Return the largest depth that a test states and the largest load of its program, each with its unit."""
    depths = [f"{results[key]} {unit[1]}" for key in results if (unit := re.fullmatch(r"hmax \[(.+)\]", key))]
    loads = [" ".join(found) for found in re.findall(r"([\d.,]+) ?(\w?N)\b", program.get("F", ""))]
    return {LARGEST[key]: found[0] for key, found in (("depth", depths), ("load", loads)) if found}


READER = Reader("fischer", "Fischer HM2000/Picodentor export", matches, read)
