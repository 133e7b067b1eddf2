"""The tests of files and folders that a draft can take, and why it leaves out the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from indentation_files.borne_load import check_borne
from indentation_files.readers import (
    ColumnMap,
    Unreadable,
    VendorTest,
    messages,
    raise_if_unreadable,
    read_each,
    zeroed_each,
)
from indentation_files.readers.vendor import read_or_report
from indentation_files.recording import STIFFNESS_FOLDER
from indentation_files.sentences import first_few
from palpate.draft.drafted import Drafted
from palpate.errors import InputError


def readable(
    files: Sequence[Path],
    report: Callable[[str], None],
    contact: str | float = "file",
    corrections: frozenset[str] | None = None,
    columns: ColumnMap | None = None,
) -> list[Drafted]:
    """Return all tests of files that can be read, and say of other files and tests why they are left out.

    Parameters
    ----------
    files
        Recordings, vendors' files, or folders of them.
    report
        Called with one line for what is left out, and for each warning of the readers.
    contact, corrections, columns
        As for `indentation_files.readers.read_vendor_file`.

    Raises
    ------
    InputError
        What is wrong with the first file or test, when none can be read.
    """
    refused: list[InputError] = []
    found: list[tuple[Path, list[Drafted | Unreadable]]] = []
    for given in files:
        if beside := _folders_beside_files(given):
            report(f"{given}: its folders are left out ({first_few(beside)}); name them to draft their tests")
    for file in [file for given in files for file in _files_in(given)]:
        try:
            if file.is_dir():
                raise InputError("is a folder without files", remedy="name the folder that holds the recordings")
            whole = _borne(file, read_each(file, corrections=corrections, contact="none", columns=columns))
            found.append((file, _begun(file, whole, zeroed_each(file, whole, contact), corrections)))
        except InputError as error:
            refused.append(error.located(file=file))
    drafted = [test for _, tests in found for test in tests if isinstance(test, Drafted)]
    if not drafted:
        raise refused[0]
    for reason in refused:
        report(f"{reason}; the file is left out")
    for file, tests in found:
        for line in messages(file, [test.source if isinstance(test, Drafted) else test for test in tests]):
            report(line)
    return drafted


def _files_in(given: Path) -> list[Path]:
    """Return a file, or the visible files of a folder by name; a folder without any as it is."""
    if not given.is_dir():
        return [given]
    return sorted(file for file in given.iterdir() if file.is_file() and not file.name.startswith(".")) or [given]


def _folders_beside_files(given: Path) -> list[str]:
    """Return the names of the visible folders in a folder that holds files, too; that of stiffness does not count."""
    if not given.is_dir() or _files_in(given) == [given]:
        return []
    names = (each.name for each in given.iterdir() if each.is_dir() and not each.name.startswith("."))
    return sorted(name for name in names if name != STIFFNESS_FOLDER)


def _borne(file: Path, tests: Sequence[VendorTest | Unreadable]) -> list[VendorTest | Unreadable]:
    """Return the tests of a file; one that never bears load becomes one that cannot be read."""
    return [read_or_report(file, test.name, _pressed, test) if isinstance(test, VendorTest) else test for test in tests]


def _pressed(test: VendorTest) -> VendorTest:
    check_borne(test.recording)
    return test


def _begun(
    file: Path,
    whole: Sequence[VendorTest | Unreadable],
    tests: Sequence[VendorTest | Unreadable],
    corrections: frozenset[str] | None,
) -> list[Drafted | Unreadable]:
    """Return the tests of one file as a draft takes them; raises `InputError` when it can take none."""
    found: list[Drafted | Unreadable] = []
    for test, all_of_it in zip(tests, whole, strict=True):
        try:
            found.append(Drafted.of(file, raise_if_unreadable(test), corrections, raise_if_unreadable(all_of_it)))
        except InputError as error:
            found.append(test if isinstance(test, Unreadable) else Unreadable(test.name, error))
    unreadable = [test for test in found if isinstance(test, Unreadable)]
    if len(unreadable) == len(found):
        raise next((test for test in unreadable if test.sought), unreadable[0]).error
    return found
