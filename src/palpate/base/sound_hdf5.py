"""Whether an HDF5 file can be read at all: tried in a process of its own whose memory and time are bounded.

A file of a few kilobytes may state a table of many gigabytes, or be damaged so that the library crashes.
"""

from __future__ import annotations

import io
from typing import Any

from palpate.base.bounded_process import BEYOND, parsed, serve


def problem_of(content: bytes) -> str:
    """Return what keeps the bytes of an HDF5 file from being read; empty where nothing does."""
    found = parsed(__file__, content)
    return BEYOND if found is None else str(found)


def _problem(content: bytes) -> str:
    """Return what h5py meets when every table is read once, one after the other."""
    import h5py

    def visit(path: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            item[()]

    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            file.visititems(visit)
    except MemoryError:
        raise
    except Exception as error:  # on damage the library raises whatever it meets
        return type(error).__name__
    return ""


if __name__ == "__main__":
    serve(_problem)
