"""Errors that a user can correct: each states the problem, the remedy, and the place."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

REMEDIES = {errno.ENOSPC: "free space on the disk", errno.EDQUOT: "free space on the disk"}


class PalpateError(Exception):
    """Base of every error that palpate and its readers of files raise on purpose."""


class InputError(PalpateError):
    """Bad input from outside: a file, a configuration key, a parameter value.

    Parameters
    ----------
    problem
        What is wrong, with the value that came and what was expected.
    remedy
        What the user should do.
    file
        The file that holds the mistake, if there is one.
    place
        Where in the file: a key, a line, a column.
    """

    def __init__(self, problem: str, *, remedy: str, file: str | Path | None = None, place: str | None = None):
        self.problem, self.remedy, self.file, self.place = problem, remedy, file, place
        where = ", ".join(str(part) for part in (file, place) if part is not None)
        line = f"{where}: {problem}; {remedy}" if where else f"{problem}; {remedy}"
        super().__init__(" ".join(line.split()))

    def located(self, *, file: str | Path | None = None, place: str | None = None) -> InputError:
        """Return the same error with a file or a place filled in where it had none."""
        return InputError(self.problem, remedy=self.remedy, file=self.file or file, place=self.place or place)


@contextmanager
def located_in(file: str | Path | None = None, place: str | None = None) -> Iterator[None]:
    """Fill in the file or the place of an `InputError` raised inside, where it has none."""
    try:
        yield
    except InputError as error:
        raise error.located(file=file, place=place) from None


@contextmanager
def part_of(place: str) -> Iterator[None]:
    """Put `place` before the place of an `InputError` raised inside; an error of another file keeps its own place."""
    try:
        yield
    except InputError as error:
        if error.file is not None:
            raise
        inner = ".".join(filter(None, [place, error.place]))
        raise InputError(error.problem, remedy=error.remedy, place=inner) from None


def of_system(error: OSError | MemoryError) -> InputError:
    """Return what the system refuses, such as a file that may not be written, as one line."""
    if isinstance(error, MemoryError):
        return InputError("the memory does not suffice", remedy="use smaller files or fewer levels")
    remedy = REMEDIES.get(error.errno or 0, "check the path and its permissions")
    return InputError(error.strerror or str(error), remedy=remedy, file=error.filename)
