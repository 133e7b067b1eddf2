"""Tests that do not count unless somebody names one: averages, sheets that the vendor's program tags, other names.

A remark in the name of a sheet is reported where half of the sheets or more bear none.

TestWorks (MTS, Agilent) writes ``Test 004 Tagged`` for a test that the operator took out of the averages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from palpate.errors import InputError
from palpate.recordings.readers.source import TEST, Source, number_of
from palpate.recordings.readers.units import CHANNELS
from palpate.recordings.readers.vendor import Unreadable, VendorTest

TAGGED = re.compile(
    r"(?<![^\W_])(?:tagged|excluded|rejected|discarded|omitted|ignored|aborted|invalid|bad)(?![^\W_])", re.IGNORECASE
)
AVERAGED = re.compile(
    r"(?:(?:the )?(?:average|averages|avg|mean|means|median|mittelwerte?|durchschnitt|moyennes?|promedio)"
    r"|(?:average|avg|mean|median)[ _-](?:curve|data|test|of[ _-].*)|std|st ?dev|standard deviations?)",
    re.IGNORECASE,
)


def set_aside(source: Source, test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test, or why it is left out: its name tags it or is an average's, or its reader says it may be none."""
    if isinstance(test, Unreadable):
        return test
    mark = TAGGED.search(test.name) if source.workbook else None
    mark = mark or (AVERAGED.fullmatch(test.name.strip()) if test.name != source.path.stem else None)
    reason = f"the vendor's file calls it {mark[0].lower()}" if mark else test.uncounted
    if not reason:
        return test
    error = InputError(
        reason,
        remedy=f"`--test {test.name!r}`, or the name in a study's source.conditions, takes it all the same",
        file=source.path,
        place=test.name,
    )
    return Unreadable(test.name, error, uncounted=test)


def not_shown(source: Source) -> list[Unreadable]:
    """Return the hidden sheets of a workbook that hold a table: two rows or more that fill three cells."""
    error = InputError(
        "is hidden in the workbook", remedy="show it in a spreadsheet program if it counts", file=source.path
    )
    rows = {name: source.sheet(name) for name in source.hidden}
    filled = {name: [sum(bool(str(cell).strip()) for cell in row) for row in rows[name]] for name in rows}
    tables = [name for name, counts in filled.items() if sum(count >= len(CHANNELS) for count in counts) >= 2]
    return [Unreadable(name, error.located(place=f"sheet {name}"), sought=False) for name in tables]


@contextmanager
def no_less_hidden(source: Source) -> Iterator[None]:
    """Say of a workbook that cannot be read which of its sheets are hidden, where some are."""
    try:
        yield
    except InputError as error:
        names = [sheet.name for sheet in not_shown(source)]
        if not names:
            raise
        problem = f"{error.problem} (hidden sheets, which are left out: {', '.join(names)})"
        raise InputError(problem, remedy=error.remedy, file=error.file, place=error.place) from None


def remarked(source: Source, tests: Sequence[VendorTest | Unreadable]) -> list[VendorTest | Unreadable]:
    """Return the tests, with a warning where a sheet bears a remark beside its number, as no more than half do."""
    beside = [TEST.sub("", test.name, count=1).strip(" _-#()") for test in tests]
    numbered = sum(number_of(test.name) is not None and not name for test, name in zip(tests, beside, strict=True))
    if not source.workbook or 2 * numbered < len(tests):
        return list(tests)
    return [
        replace(test, warnings=(*test.warnings, f"the sheet's name says {name!r}: look whether the test counts"))
        if isinstance(test, VendorTest) and name
        else test
        for test, name in zip(tests, beside, strict=True)
    ]


def taken(test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test that somebody names, be it left out otherwise or not; a warning states that it is."""
    if isinstance(test, VendorTest) or test.uncounted is None:
        return test
    return replace(test.uncounted, warnings=(*test.uncounted.warnings, test.error.problem))
