"""What an execution that was killed leaves in a folder: Snakemake's locks, which would stop the next one.

Snakemake's locks name files, not the process that holds them. They are taken away where `palpate run` left them on this
machine, and none of its processes, or of any Snakemake, is left in the folder: an execution on another machine that
shares the folder cannot be seen from here, so its locks stay.
"""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import psutil

KEPT, MARK = Path(".snakemake"), "run_by_palpate_on_"


def locks(folder: Path, results: str = "") -> list[Path]:
    """Return Snakemake's locks of a folder, those on files whose names begin with `results`."""
    found = sorted((folder / KEPT / "locks").glob("*.lock"))
    return [lock for lock in found if not results or f"\n{results}" in "\n" + lock.read_text(errors="replace")]


def unlocked(folder: Path) -> bool:
    """Take away the locks of an execution that was killed; return whether there were any and they are gone."""
    left, mark = locks(folder), _mark(folder)
    if not left or list(mark.parent.glob(f"{MARK}*")) != [mark] or running(folder):
        return False
    for lock in left:
        lock.unlink(missing_ok=True)
    return True


@contextmanager
def marked(folder: Path) -> Iterator[None]:
    """Mark a folder while this machine executes a study there; what is killed leaves the mark.

    Where there are locks already that no mark explains, none is set, so that they are never taken away.
    """
    mark = _mark(folder)
    if not locks(folder):
        mark.parent.mkdir(exist_ok=True)
        mark.touch()
    try:
        yield
    finally:
        if not locks(folder):
            mark.unlink(missing_ok=True)


def running(folder: Path) -> bool:
    """Return whether an execution, or a job that one left, works in a folder on this machine.

    A process of Snakemake whose folder may not be seen, as it is another user's, counts as well.
    """
    here = str(folder.resolve())
    found = psutil.process_iter(["cwd", "cmdline"])
    return any(process.info["cwd"] in (here, None) and _names_snakemake(process.info["cmdline"]) for process in found)


def _names_snakemake(words: Sequence[str] | None) -> bool:
    """Return whether a command line is that of Snakemake, or of a script that it runs."""
    return any(Path(word).name == "snakemake" or ".snakemake/scripts/" in word for word in words or ())


def _mark(folder: Path) -> Path:
    return folder / KEPT / f"{MARK}{platform.node()}"
