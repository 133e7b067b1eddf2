"""Results as JSON files, and the checksums by which a result that was altered is recognised.

Each job leaves the checksums of its results beside its log, in a file that ``sha256sum --check`` reads. A result that
is no longer as its job made it is moved before the next execution, so that it is missing and made again. Where no job
has begun to make it when the execution ends, as after a dry run, it is moved back.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

from palpate.base.whole_file import written_whole
from palpate.errors import PalpateError

SEAL, ASIDE = ".sha256", ".altered"


@dataclass(frozen=True)
class Altered:
    """A result that is no longer as its job made it.

    Parameters
    ----------
    file
        Where the job wrote it.
    sealed
        The checksums of the results of this job.
    kept
        Where it is moved.
    """

    file: Path
    sealed: Path
    kept: Path

    def __str__(self) -> str:
        return f"{self.file} is not as it was made; when it is made again, it is kept as {self.kept.name}"


def write_json(path: str | Path, content: Mapping[str, Any] | Sequence[Any]) -> None:
    """Write JSON; the file appears whole or not at all."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(path) as partial:
        partial.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def read_json(path: str | Path) -> Any:
    """Read JSON that the workflow wrote.

    Raises
    ------
    PalpateError
        When it was cut or altered so that it is JSON no more, or is no file.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError, IsADirectoryError) as error:
        raise PalpateError(f"{path} is damaged ({error}); delete it and run the study again") from error


def checksum(file: Path) -> str:
    """Return the SHA-256 of a file."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def seal(log: str | Path, results: Iterable[str | Path]) -> None:
    """Write the checksums of a job's results beside its log."""
    lines = [f"{checksum(file)}  {file}\n" for file in map(Path, results) if file.is_file()]
    Path(log).with_suffix(SEAL).write_text("".join(lines), encoding="utf-8")


def unseal(log: str | Path) -> None:
    """Remove the checksums of a job's former results, which it is about to replace."""
    Path(log).with_suffix(SEAL).unlink(missing_ok=True)


def altered(logs: Path) -> Iterator[Altered]:
    """Yield the results that are no longer as the jobs whose logs lie in a folder made them; missing ones are not.

    Of a result that two logs name, as where an earlier version named them otherwise, the later one counts.
    """
    made: dict[str, tuple[str, Path]] = {}
    for sealed in sorted(logs.rglob(f"*{SEAL}"), key=lambda file: (file.stat().st_mtime_ns, file)):
        for line in sealed.read_text(encoding="utf-8", errors="replace").splitlines():
            known, _, name = line.partition("  ")
            made[name] = known, sealed
    for name, (known, sealed) in sorted(made.items()):
        file = Path(name)
        if name and file.is_relative_to(logs.parent) and file.is_file() and checksum(file) != known:
            yield Altered(file, sealed, _free(file.with_name(file.name + ASIDE)))


def _free(path: Path) -> Path:
    """Return a path at which nothing is: `path`, or with a number that follows it."""
    numbered = (path.with_name(f"{path.name}_{number}") for number in count(2))
    return next(place for place in chain([path], numbered) if not os.path.lexists(place))


def move_aside(results: Iterable[Altered]) -> None:
    """Move results that were altered, so that they are missing and made again."""
    for result in results:
        result.file.replace(result.kept)


def move_back(results: Iterable[Altered], folder: Path) -> None:
    """Move results back that were moved aside, but for those that a job has begun to make again: it unseals them first.

    Parameters
    ----------
    folder
        From which paths count; the working folder may be another by now.
    """
    for result in results:
        file = folder / result.file
        if (folder / result.sealed).is_file() and not os.path.lexists(file):
            (folder / result.kept).replace(file)


def estimate_of(file: str | Path) -> dict[str, float]:
    """Return the estimate that the file of a calibration holds, by parameter."""
    return {name: row["estimate"] for name, row in read_json(file)["parameters"].items()}
