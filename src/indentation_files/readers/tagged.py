"""Tests that do not count unless somebody names one: averages, sheets that the vendor's program tags, other names.

A remark in the name of a sheet is reported where half of the sheets or more bear none.

TestWorks (MTS, Agilent) writes ``Test 004 Tagged`` for a test that the operator took out of the averages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from indentation_files.errors import InputError
from indentation_files.readers.source import TEST, Source, number_of
from indentation_files.readers.units import CHANNELS
from indentation_files.readers.vendor import Unreadable, VendorTest
from indentation_files.recording import COMPARED, Recording, last_digit

TAGGED = re.compile(
    r"(?<![^\W_])(?:tagged|excluded|rejected|discarded|omitted|ignored|aborted|invalid|bad)(?![^\W_])", re.IGNORECASE
)
OF_MEAN = (
    r"(?:averages?|avg|means?|median|mittelwerte?|mittel|mittlere[rs]?|durchschnitt|moyenn?es?|promedio|m[eé]di[ao]"
    r"|gemiddelden?)"
)
OF_TEST = (
    r"(?:tests?|specimens?|samples?|prob(?:e|en)|proben|[eé]prouvettes?|essais?|courbes?|probetas?|provin[oi]|campion[ei]"
    r"|curvas?|curves?|kurven?|valore?)"
)
AVERAGED = re.compile(
    rf"(?:(?:the )?{OF_MEAN}|{OF_MEAN}[ _-]?(?:data|of[ _-].*|d(?:e[sil]?|ei)[ _-].*|{OF_TEST})"
    rf"|{OF_TEST}[ _-]?{OF_MEAN}|std|st ?dev|standard deviations?)(?:[ _-]?\(?n ?= ?\d+\)?)?",
    re.IGNORECASE,
)
ALIKE = 1e-3  # of a channel's range, chosen: the mean of rounded and interpolated curves is as near the others' mean
UNLIKE = 0.03  # of the others' scatter about their mean, chosen: a replicate is seldom as near, in load and depth
APART = 5.0  # times ALIKE, chosen: by which some of the others lie off their mean


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


def averages(tests: Sequence[VendorTest | Unreadable]) -> list[VendorTest | Unreadable]:
    """Return the tests; one that is the mean of all others by its load and depth, not by its name, is uncounted.

    The middle one of evenly spaced curves is the mean of the others too, and bears a number as they do.
    """
    curves = {k: test.recording for k, test in enumerate(tests) if isinstance(test, VendorTest)}
    if any(AVERAGED.fullmatch(tests[k].name.strip()) for k in curves):
        return list(tests)
    found = [k for k in curves if _is_mean(curves[k], [curve for j, curve in curves.items() if j != k])]
    if len(found) > 1:
        found = [k for k in found if not any(map(str.isdigit, tests[k].name))]
    reason = "its load and depth are the mean of the other tests'"
    return [
        replace(test, uncounted=reason) if [k] == found and isinstance(test, VendorTest) else test
        for k, test in enumerate(tests)
    ]


def _is_mean(curve: Recording, others: Sequence[Recording]) -> bool:
    """Return whether a curve is the mean of two others or more, at equal times of the whole test.

    It is where it is as near to their mean as its digits allow, which no replicate with noise of its own is, or where
    both load and depth are nearer than those of a replicate are.
    """
    if len(others) < 2:
        return False
    since = [other.time - other.time[0] for other in (curve, *others)]
    time = np.linspace(0.0, min(float(clock[-1]) for clock in since), COMPARED)
    exact, near, apart = True, True, []
    for key in ("load", "depth"):
        values = [np.interp(time, clock, getattr(r, key)) for clock, r in zip(since, (curve, *others), strict=True)]
        mean, span = np.mean(values[1:], axis=0), float(np.ptp(values[0]))
        scatter = float(np.sqrt(np.mean((np.array(values[1:]) - mean) ** 2)))
        off = float(np.sqrt(np.mean((values[0] - mean) ** 2)))
        exact &= off <= min(ALIKE * span, last_digit(getattr(curve, key)))
        near &= off <= min(ALIKE * span, UNLIKE * scatter)
        apart.append(max(float(np.abs(each - mean).max()) for each in values[1:]) > APART * ALIKE * span)
    return (exact and any(apart)) or (near and apart[0])


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


def selected(test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test that somebody names, be it left out otherwise or not; a warning states that it is."""
    if isinstance(test, VendorTest) or test.uncounted is None:
        return test
    return replace(test.uncounted, warnings=(*test.uncounted.warnings, test.error.problem))
