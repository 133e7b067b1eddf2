"""Workbooks and HDF5 files, parsed in a process of its own whose memory and time are bounded.

A damaged or hostile file can make its parser allocate or loop without end, panic or abort, and one of a few kilobytes
may state a table of many gigabytes. Here that ends the other process.
"""

from __future__ import annotations

import io
import pickle
import resource
import subprocess
import sys
from dataclasses import dataclass, field
from typing import Any

MEMORY = 1 << 30  # bytes
SECONDS = 10  # of the processor
BEYOND = f"it takes more than {MEMORY >> 30} GB or {SECONDS} s to read"


@dataclass(frozen=True)
class Workbook:
    """What a workbook holds.

    `sheets` has the rows of each sheet by its name, behind the numbers of its first row and first column that hold
    anything, from 1; `damaged` what is wrong with those that cannot be read. `hidden` names the sheets that a
    spreadsheet program does not show. `problem` says what is wrong with the whole workbook; empty where nothing is.
    """

    sheets: dict[str, tuple[int, int, list[list[Any]]]] = field(default_factory=dict)
    damaged: dict[str, str] = field(default_factory=dict)
    hidden: list[str] = field(default_factory=list)
    problem: str = ""


def read_workbook(content: bytes) -> Workbook:
    """Return what the bytes of a workbook hold."""
    found = _parsed("workbook", content)
    return Workbook(problem=BEYOND) if found is None else Workbook(*found)


def _workbook(content: bytes) -> tuple[dict[str, tuple[int, int, list[list[Any]]]], dict[str, str], list[str], str]:
    """Return what a `Workbook` holds."""
    from python_calamine import CalamineWorkbook, SheetVisibleEnum

    sheets, damaged = {}, {}
    try:
        workbook = CalamineWorkbook.from_filelike(io.BytesIO(content))
    except MemoryError:
        raise
    except BaseException as error:  # on some damage the library panics, which is no Exception
        return {}, {}, [], str(error)
    for name in workbook.sheet_names:
        try:
            sheet = workbook.get_sheet_by_name(name)
            row, column = sheet.start or (0, 0)
            sheets[name] = row + 1, column + 1, sheet.to_python()
        except MemoryError:
            raise
        except BaseException as error:
            damaged[name] = str(error)
    hidden = [sheet.name for sheet in workbook.sheets_metadata if sheet.visible != SheetVisibleEnum.Visible]
    return sheets, damaged, hidden, ""


@dataclass(frozen=True)
class Hdf5Tables:
    """One-dimensional tables of an HDF5 file.

    `groups` has for each group by its path its columns of numbers by their names, each with the attributes of the
    column, `attributes` those of each group as text. `problem` says what is wrong with the file; empty where nothing
    is.
    """

    groups: dict[str, dict[str, tuple[list[float], dict[str, str]]]] = field(default_factory=dict)
    attributes: dict[str, dict[str, str]] = field(default_factory=dict)
    problem: str = ""


def read_hdf5(content: bytes) -> Hdf5Tables:
    """Return the tables that the bytes of an HDF5 file hold."""
    found = _parsed("hdf5", content)
    return Hdf5Tables(problem=BEYOND) if found is None else Hdf5Tables(*found)


def problem_of(content: bytes) -> str:
    """Return what keeps the bytes of an HDF5 file, all of its tables, from being read; empty where nothing does."""
    found = _parsed("whole hdf5", content)
    return BEYOND if found is None else str(found[-1])


def _hdf5(content: bytes, whole: bool = False) -> tuple[dict[str, Any], dict[str, dict[str, str]], str]:
    """Return what `Hdf5Tables` holds; of a `whole` file each table is read once, of whatever shape, and none kept."""
    import h5py

    groups: dict[str, Any] = {}
    attributes: dict[str, dict[str, str]] = {}

    def take(path: str, item: Any) -> None:
        if whole:
            _ = item[()] if isinstance(item, h5py.Dataset) else None
        elif isinstance(item, h5py.Group):
            groups[path], attributes[path] = {}, _texts(item.attrs)
        elif item.ndim == 1 and item.dtype.kind in "iuf":
            parent, _, name = path.rpartition("/")
            groups[parent][name] = item[()].tolist(), _texts(item.attrs)

    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            take("", file)
            file.visititems(take)
    except MemoryError:
        raise
    except Exception as error:  # on damage the library raises whatever it meets
        return {}, {}, type(error).__name__
    return groups, attributes, ""


def _texts(attributes: Any) -> dict[str, str]:
    return {str(name): _text(value) for name, value in attributes.items()}


def _text(value: Any) -> str:
    """Return an attribute as text, be it text, bytes, a number or a list of one of them."""
    single = value.ravel()[0] if getattr(value, "size", 0) == 1 and hasattr(value, "ravel") else value
    return single.decode(errors="replace") if isinstance(single, bytes) else str(single)


def _parsed(kind: str, content: bytes) -> Any:
    """Return what this file, run on bytes of a kind, makes of them; None where it came to no end."""
    command = [sys.executable, "-P", __file__, kind]
    try:
        found = subprocess.run(command, input=content, capture_output=True, timeout=2 * SECONDS)
    except subprocess.TimeoutExpired:
        return None
    return None if found.returncode else pickle.loads(found.stdout)


def _serve(kind: str) -> None:
    """Answer to `_parsed`: write what the bytes on the standard input hold."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    content = sys.stdin.buffer.read()
    found = _workbook(content) if kind == "workbook" else _hdf5(content, whole=kind.startswith("whole"))
    sys.stdout.buffer.write(pickle.dumps(found))


if __name__ == "__main__":
    _serve(sys.argv[1])
