"""What a command may write: never over the file that it reads, nor over other results; and nothing when it fails."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from indentation_files.errors import InputError


def checked_output(source: Path, output: Path) -> Path:
    """Return `output`, which is not the file `source`, under whatever name.

    Raises `InputError` when it is: what `source` holds, and a curve does not, would be lost.
    """
    if output.exists() and output.samefile(source):
        raise InputError("the output would replace the file that is read", remedy="name another output", file=source)
    return output


def written_beside(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` make a file at a place; return it: `path`, or ``NAME_2`` where that exists with another content."""
    made = path.with_name(f".{path.name}.new{path.suffix}")
    try:
        write(made)
        content, number, place = made.read_bytes(), 1, path
        while place.exists() and not (place.is_file() and place.read_bytes() == content):
            number += 1
            place = path.with_name(f"{path.stem}_{number}{path.suffix}")
        made.replace(place)
    finally:
        made.unlink(missing_ok=True)
    return place


@contextmanager
def rolled_back_on_error(study: Path, folder: Path) -> Iterator[None]:
    """Remove a study, its `folder` of recordings and the folders made for them when the block ends with an error.

    Neither of the two may exist before; what else lies in an output folder stays.
    """
    made = [path for path in folder.parents if not path.exists()]
    try:
        yield
    except BaseException:
        with suppress(OSError):
            study.unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        for path in made:
            with suppress(OSError):
                path.rmdir()
        raise
