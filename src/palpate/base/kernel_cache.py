"""Where compiled kernels are kept: a folder for each state of their sources.

numba notices a change of the file that a kernel is in, but not of kernels that it calls from other files. So the cache
bears the hash of all sources that hold kernels and of the form in which they are kept, and an update of the package
never meets machine code of the old one.

It lies where ``NUMBA_CACHE_DIR`` says, or else in the package, or else in the user's own cache, or else in the folder
for temporary files. There it is the user's alone, because numba executes what it finds.
"""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from palpate.base.checksum import checksum
from palpate.errors import InputError

PACKAGE = Path(__file__).parents[1]
SOURCES = ("solver/axisymmetric", "solver/pyramid", "materials", "materials/flow")
FORM = tuple(Path(__file__).with_name(name) for name in ("checked_kernels.py", "inner_kernel.py"))
VARIABLE, PREFIX = "NUMBA_CACHE_DIR", "kernels-"


def choose() -> None:
    """Point numba, before it is imported, at the folder of these sources: where it is told, or else can be written.

    A process inherits the variable from the one that began it, which may have other sources.
    """
    kernels = (file for folder in SOURCES for file in sorted((PACKAGE / folder).glob("*.py")))
    name = f"{PREFIX}{checksum(*FORM, *kernels)[:12]}"
    if given := os.environ.get(VARIABLE):
        os.environ[VARIABLE] = str(_place(Path(given)) / name)
    elif found := kept(name):
        os.environ[VARIABLE] = str(found)


def _place(given: Path) -> Path:
    """Return where folders of kernels lie, given that place or one of them."""
    return given.parent if given.name.startswith(PREFIX) else given


def kept(name: str) -> Path | None:
    """Return the first folder of a name that can be written; none where there is no such place."""
    return next((parent / name for parent in _parents() if usable(parent / name)), None)


def require() -> None:
    """Check that kernels can be kept, without which numba compiles none, and have each kept with its checksum.

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
    if not usable(Path(given)):
        raise InputError(f"{VARIABLE} is {_place(Path(given))}, which cannot be written", remedy=remedy)
    from palpate.base import checked_kernels

    checked_kernels.install()


def _parents() -> Iterator[Path]:
    """Return the folders that may hold the cache, the best first."""
    yield PACKAGE / "__pycache__"
    if (own_cache := user_cache() / "palpate").is_absolute():  # else the user has no home folder
        yield own_cache
    yield Path(_temporary(), f"palpate-kernels-{os.getuid()}")


def user_cache() -> Path:
    """Return the user's folder for what programs keep, which may be missing or read-only."""
    return Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))


def _temporary() -> str:
    try:
        return tempfile.gettempdir()
    except FileNotFoundError:  # there is none that can be written
        return os.environ.get("TMPDIR", "/tmp")


def usable(folder: Path) -> bool:
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
