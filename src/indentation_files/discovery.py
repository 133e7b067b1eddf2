"""Finding the members of a folder: one file each, known by the name that it defines."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable, Iterator
from typing import Any


def discover(package: str, path: Iterable[str], attribute: str) -> Iterator[Any]:
    """Yield `attribute` of every module in `package` that defines it, in alphabetical order of the modules."""
    for module in sorted(pkgutil.iter_modules(path), key=lambda found: found.name):
        loaded = importlib.import_module(f"{package}.{module.name}")
        if hasattr(loaded, attribute):
            yield getattr(loaded, attribute)
