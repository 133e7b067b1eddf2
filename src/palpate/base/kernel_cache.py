"""Where compiled kernels are kept: a folder for each state of their sources.

numba notices a change of the file that a kernel is in, but not of kernels that it calls from other files. So the cache
bears the hash of all sources that hold kernels, and an update of the package never meets machine code of the old one.

It lies in the package, or else in the user's own cache, or else in the folder for temporary files. There it is the
user's alone, because numba executes what it finds.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from palpate.errors import InputError

PACKAGE = Path(__file__).parents[1]
SOURCES = ("solver/axisymmetric", "solver/pyramid", "materials", "materials/flow")
VARIABLE = "NUMBA_CACHE_DIR"


def choose() -> None:
    """Point numba, before it is imported, at the first folder that can be written; ``NUMBA_CACHE_DIR`` overrules it."""
    if VARIABLE not in os.environ:
        digest = hashlib.sha256()
        for folder in SOURCES:
            for file in sorted((PACKAGE / folder).glob("*.py")):
                digest.update(file.read_bytes())
        if found := kept(f"kernels-{digest.hexdigest()[:12]}"):
            os.environ[VARIABLE] = str(found)


def kept(name: str) -> Path | None:
    """Return the first folder of a name that can be written; none where there is no such place."""
    return next((parent / name for parent in _parents() if _usable(parent / name)), None)


def require() -> None:
    """Check that kernels can be kept, without which numba compiles none.

    Raises
    ------
    InputError
        When there is no folder for them, or that of ``NUMBA_CACHE_DIR`` cannot be written.
    """
    remedy = f"set {VARIABLE} to a folder of yours that can be written"
    given = os.environ.get(VARIABLE)
    if given is None:
        tried = ", ".join(map(str, _parents()))
        raise InputError(
            f"compiled kernels can be kept in none of {tried}: they are read-only, or another user's", remedy=remedy
        )
    if not _usable(Path(given)):
        raise InputError(f"{VARIABLE} is {given}, which cannot be written", remedy=remedy)


def _parents() -> Iterator[Path]:
    """Return the folders that may hold the cache, the best first."""
    yield PACKAGE / "__pycache__"
    yield Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "palpate"
    yield Path(_temporary(), f"palpate-kernels-{os.getuid()}")


def _temporary() -> str:
    try:
        return tempfile.gettempdir()
    except FileNotFoundError:  # there is none that can be written
        return os.environ.get("TMPDIR", "/tmp")


def _usable(folder: Path) -> bool:
    """Return whether a file can be written to a folder, which is made where it is missing."""
    if folder.parent.name.startswith("palpate-kernels-") and not own(folder.parent):
        return False
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def own(folder: Path) -> bool:
    """Make a folder that nobody but the user may enter; return whether it is one, and not a link to another."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077
