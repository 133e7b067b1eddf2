"""HDF5 files, read by h5py in a process of its own whose memory and time are bounded.

A file of a few kilobytes may state a table of many gigabytes, or be damaged so that the library crashes.
"""

from __future__ import annotations

import importlib.util
import io
import sys
from dataclasses import dataclass, field
from typing import Any

from indentation_files.bounded_process import BEYOND, parsed, serve

WHOLE = "--whole"  # argument of this file's own process


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


def available() -> bool:
    """Return whether the library h5py is installed."""
    return importlib.util.find_spec("h5py") is not None


def read_hdf5(content: bytes) -> Hdf5Tables:
    """Return the tables that the bytes of an HDF5 file hold."""
    found = parsed(__file__, content)
    return Hdf5Tables(problem=BEYOND) if found is None else Hdf5Tables(*found)


def problem_of(content: bytes) -> str:
    """Return what keeps the bytes of an HDF5 file, all of its tables, from being read; empty where nothing does."""
    found = parsed(__file__, content, WHOLE)
    return BEYOND if found is None else str(found[-1])


def _read(content: bytes) -> tuple[dict[str, Any], dict[str, dict[str, str]], str]:
    """Return what `Hdf5Tables` holds; of the `WHOLE` file each table is read once, of whatever shape, and none kept."""
    import h5py

    groups: dict[str, Any] = {}
    attributes: dict[str, dict[str, str]] = {}

    def take(path: str, item: Any) -> None:
        if WHOLE in sys.argv:
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


if __name__ == "__main__":
    serve(_read)
