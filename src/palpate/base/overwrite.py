"""What a command may write: never over the file that it reads."""

from __future__ import annotations

from pathlib import Path

from palpate.errors import InputError


def spared(source: Path, output: Path) -> Path:
    """Return `output`, which is not the file `source`, under whatever name.

    Raises
    ------
    InputError
        When it is: what `source` holds, and a curve does not, would be lost.
    """
    if output.exists() and output.samefile(source):
        raise InputError("the output would replace the file that is read", remedy="name another output", file=source)
    return output
