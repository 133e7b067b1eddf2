"""Libraries that some studies of the thesis need, and palpate does not."""

from __future__ import annotations

import importlib
from types import ModuleType

from palpate.errors import InputError


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
