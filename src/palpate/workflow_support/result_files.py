"""Results as JSON files, and the checksum of a file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from palpate.base.whole_file import written_whole
from palpate.errors import PalpateError


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
        When it was cut or altered so that it is JSON no more.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise PalpateError(f"{path} is damaged ({error}); delete it and run the study again") from error


def checksum(file: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def estimate_of(file: str | Path) -> dict[str, float]:
    """Return the estimate that the file of a calibration holds, by parameter."""
    return {name: row["estimate"] for name, row in read_json(file)["parameters"].items()}
