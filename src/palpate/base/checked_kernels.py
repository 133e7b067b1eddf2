"""Compiled kernels that are recognised when they were cut or altered, and compiled again.

numba unpickles and executes what its cache holds as it is. Here each compiled kernel follows its SHA-256, so that a
damaged one is as one that is missing.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

from numba.core import caching

from palpate.base.checksum import DIGITS, checksum


class CheckedCacheFile(caching.IndexDataCacheFile):
    """numba's index of the compiled versions of one function, and their files."""

    def _load_index(self) -> dict[Any, str]:
        try:
            return dict(super()._load_index())
        except Exception:  # damaged pickles may raise anything
            return {}

    def _save_data(self, name: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(checksum(content).encode() + content)

    def _load_data(self, name: str) -> Any:
        stored = Path(self._data_path(name)).read_bytes()
        if checksum(stored[DIGITS:]).encode() != stored[:DIGITS]:
            raise OSError(f"{name} is damaged")  # numba compiles what it cannot read
        return pickle.loads(stored[DIGITS:])


def install() -> None:
    """Let numba keep kernels this way in this process."""
    caching.IndexDataCacheFile = CheckedCacheFile  # type: ignore[misc]
