"""Files that may be read: a pipe or a device in their place is refused."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from indentation_files.errors import InputError


def refuse_special(path: str | Path) -> None:
    """Raise `InputError` where there is no regular file but, say, a pipe, on which reading may wait for ever."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return
    if not stat.S_ISREG(mode):
        raise InputError("is no regular file", remedy="give a file", file=path)
