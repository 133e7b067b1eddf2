"""Files that appear whole or not at all: whoever reads one meanwhile, or after an interruption, never meets a part."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Yield the place where a file is to be written that then takes the place of `path`; nothing is left on an error.

    Each process has a place of its own, so that several may write the same file.
    """
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
