"""A temporary folder for drafts and simulated curves, until the process ends."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path


def new_folder() -> Path:
    """Return a new, empty folder that is removed when the process ends."""
    return Path(tempfile.mkdtemp(dir=_session().name))


def kept_results() -> Path:
    """Return the folder of this process' simulated curves, so that a second calibration finds those of the first."""
    return Path(_session().name) / "results"


@cache
def _session() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="palpate-")
