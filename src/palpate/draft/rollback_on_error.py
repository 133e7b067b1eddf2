"""What a draft has written is removed when an error ends it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


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
