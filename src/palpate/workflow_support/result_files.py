"""Results as JSON files, and the checksums by which a result that was altered is recognised.

Each job leaves the checksums of its results beside its log, in a file that ``sha256sum --check`` reads. A result that
is no longer as its job made it is set aside before the next execution, which makes it again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from palpate.base.whole_file import written_whole
from palpate.errors import PalpateError

SEAL, ASIDE = ".sha256", ".altered"


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


def altered(logs: Path) -> Iterator[Path]:
    """Yield the results that are no longer as the jobs whose logs lie in a folder made them; missing ones are not.

    Of a result that two logs name, as where an earlier version named them otherwise, the later one counts.
    """
    made: dict[str, str] = {}
    for sealed in sorted(logs.rglob(f"*{SEAL}"), key=lambda file: (file.stat().st_mtime_ns, file)):
        for line in sealed.read_text(encoding="utf-8", errors="replace").splitlines():
            known, _, name = line.partition("  ")
            made[name] = known
    for name in sorted(made):
        file = Path(name)
        if name and file.is_relative_to(logs.parent) and file.is_file() and checksum(file) != made[name]:
            yield file


def move_altered(logs: Path) -> Iterator[str]:
    """Move the results that were altered to ``NAME.altered``, and yield a line on each."""
    for file in altered(logs):
        aside = file.with_name(file.name + ASIDE)
        file.replace(aside)
        yield f"{file} is not as it was made; it is kept as {aside.name}, and made again"


def estimate_of(file: str | Path) -> dict[str, float]:
    """Return the estimate that the file of a calibration holds, by parameter."""
    return {name: row["estimate"] for name, row in read_json(file)["parameters"].items()}
