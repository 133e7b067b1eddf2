"""The source code that a result rests on, with all that it imports, as one checksum."""

from __future__ import annotations

import functools
from pathlib import Path

from palpate.base.checksum import checksum
from palpate.base.source_code import known, source_code

SOURCE = Path(__file__).parents[2]
DECIDE_NOTHING = (
    "palpate",
    "palpate.errors",
    "indentation_files.errors",
    "palpate.base.kernel_cache",
    "palpate.base.threads",
)


@functools.cache
def fingerprint(*start: str | Path) -> str:
    """Return a checksum of some modules and of everything of the same packages that they import, directly or not.

    Parameters
    ----------
    start
        Names of modules, such as ``palpate.solver.simulation``, or files of scripts.
    """
    with known():
        files = sorted(closure(*start), key=lambda file: (file.name, str(file)))
        return checksum("".join(f"{file.name} {source_code(file).identity}\n" for file in files).encode())


def closure(*start: str | Path) -> set[Path]:
    """Return the files of modules and of everything of this package, and beside it, that they import."""
    found: set[Path] = set()
    pending = [_file(each) if isinstance(each, str) else each for each in start]
    while pending:
        file = pending.pop()
        if file is not None and file not in found:
            found.add(file)
            pending += imported(file)
    return found


@functools.cache
def imported(file: Path) -> list[Path]:
    """Return the files of the modules that a file imports, and of those among which it discovers members."""
    code = source_code(file)
    found = [next(filter(None, map(_file, names)), None) for names in code.imports]
    found += sorted(file.parent.glob("*.py")) if code.discovers else []
    return [each for each in found if each is not None]


@functools.cache
def _file(module: str) -> Path | None:
    """Return the file of a module that lies in this package's folder or in the repository, if its code decides."""
    if module in DECIDE_NOTHING:
        return None
    for root in (SOURCE, SOURCE.parent):
        path = root.joinpath(*module.split("."))
        for file in (path.with_suffix(".py"), path / "__init__.py"):
            if file.is_file():
                return file
    return None
