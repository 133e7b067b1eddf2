"""Cells of an Excel workbook, read in a process of its own whose memory and time are bounded.

A damaged or hostile workbook can make its parser allocate without end, panic or abort. Here that ends the other
process, and the caller learns it in words.
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
SECONDS = 10


@dataclass(frozen=True)
class Workbook:
    """What a workbook holds.

    Parameters
    ----------
    sheets
        Rows of each sheet by its name, and the number of the first that holds anything, from 1.
    damaged
        What is wrong with the sheets that cannot be read, by their names.
    problem
        What is wrong with the whole workbook; empty where nothing is.
    """

    sheets: dict[str, tuple[int, list[list[Any]]]] = field(default_factory=dict)
    damaged: dict[str, str] = field(default_factory=dict)
    problem: str = ""


def read_workbook(content: bytes) -> Workbook:
    """Return what the bytes of a workbook hold."""
    try:
        found = subprocess.run(
            [sys.executable, "-P", __file__], input=content, capture_output=True, timeout=2 * SECONDS
        )
    except subprocess.TimeoutExpired:
        found = None
    if found is None or found.returncode:
        return Workbook(problem=f"it takes more than {MEMORY >> 30} GB or {SECONDS} s to read")
    return Workbook(*pickle.loads(found.stdout))


def _read(content: bytes) -> tuple[dict[str, tuple[int, list[list[Any]]]], dict[str, str], str]:
    """Return what a `Workbook` holds."""
    from python_calamine import CalamineWorkbook

    sheets, damaged = {}, {}
    try:
        workbook = CalamineWorkbook.from_filelike(io.BytesIO(content))
    except MemoryError:
        raise
    except BaseException as error:  # on some damage the library panics, which is no Exception
        return {}, {}, str(error)
    for name in workbook.sheet_names:
        try:
            sheet = workbook.get_sheet_by_name(name)
            sheets[name] = (sheet.start or (0, 0))[0] + 1, sheet.to_python()
        except MemoryError:
            raise
        except BaseException as error:
            damaged[name] = str(error)
    return sheets, damaged, ""


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    sys.stdout.buffer.write(pickle.dumps(_read(sys.stdin.buffer.read())))
