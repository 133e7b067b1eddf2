"""What a result rests on, for a hash: an object's content, and source code with all that it imports."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.source_code import known, source_code

SOURCE = Path(__file__).parents[2]
DECIDE_NOTHING = ("palpate", "palpate.errors", "palpate.base.kernel_cache", "palpate.base.threads")


@functools.cache
def fingerprint(*start: str | Path) -> str:
    """Return a hash of some modules and of everything of the same packages that they import, directly or not.

    Parameters
    ----------
    start
        Names of modules, such as ``palpate.solver.simulation``, or files of scripts.
    """
    digest = hashlib.sha256()
    with known():
        for file in sorted(closure(*start), key=lambda file: (file.name, str(file))):
            digest.update(f"{file.name} {source_code(file).identity}\n".encode())
    return digest.hexdigest()


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


def content(value: Any) -> Any:
    """Return what decides an object in terms of JSON, from every field of a dataclass that its constructor takes.

    Fields that a dataclass derives from others are left out. Numbers become floats, which JSON writes with the fewest
    digits that restore them, in every version of Python and under every locale.

    Raises
    ------
    TypeError
        For a kind of value that it does not know, rather than let two of them look the same.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {type(value).__name__: {f.name: content(getattr(value, f.name)) for f in fields(value) if f.init}}
    if isinstance(value, Mapping):
        return {str(key): content(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return content(value.tolist())
    if isinstance(value, list | tuple):
        return [content(item) for item in value]
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Real):
        return float(value) + 0.0  # a negative zero is zero
    raise TypeError(f"{type(value).__name__} has no content that a hash could rest on")
