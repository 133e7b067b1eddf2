"""Sheets that the vendor's program marks as not to be counted: left out, unless somebody names one.

TestWorks (MTS, Agilent) writes ``Test 004 Tagged`` for a test that the operator took out of the averages.
"""

from __future__ import annotations

import re
from dataclasses import replace

from palpate.errors import InputError
from palpate.recordings.readers.source import Source
from palpate.recordings.readers.vendor import Unreadable, VendorTest

TAGGED = re.compile(
    r"(?<![^\W_])(tagged|excluded|rejected|discarded|omitted|ignored|aborted|invalid|bad)(?![^\W_])", re.IGNORECASE
)


def set_aside(source: Source, test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test, or, where its sheet's name says that it is tagged, why it is left out."""
    mark = TAGGED.search(test.name)
    if not source.workbook or not mark or isinstance(test, Unreadable):
        return test
    error = InputError(
        f"the vendor's file calls it {mark[1].lower()}",
        remedy=f"`--test {test.name!r}`, or the name in a study's source.conditions, takes it all the same",
        file=source.path,
        place=test.name,
    )
    return Unreadable(test.name, error, tagged=test)


def taken(test: VendorTest | Unreadable) -> VendorTest | Unreadable:
    """Return a test that somebody names, be it tagged or not; a warning states that it is."""
    if isinstance(test, VendorTest) or test.tagged is None:
        return test
    return replace(test.tagged, warnings=(*test.tagged.warnings, test.error.problem))
