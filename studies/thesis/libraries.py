"""Libraries that some studies of the thesis need, and palpate does not."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from types import ModuleType
from typing import TypeVar

from palpate.errors import InputError

Files = TypeVar("Files")


def library(name: str) -> ModuleType:
    """Return a library of the extra ``studies``.

    Raises
    ------
    InputError
        When it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(
            f"the studies of the thesis need the library {name}", remedy=f"install it: pip install {name}"
        ) from None


def with_libraries(names: Sequence[str], files: Files) -> Files:
    """Return files once the libraries of these names are found; raise as `library` does."""
    for name in names:
        library(name)
    return files
