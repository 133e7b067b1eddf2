"""A temporary folder for drafts and simulated curves, which is removed when the process ends."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

KEPT = cache(lambda: tempfile.TemporaryDirectory(prefix="palpate-"))


def kept_results() -> Path:
    """Return the folder of this process' simulated curves, so that a second calibration finds those of the first."""
    return Path(KEPT().name) / "results"


def new_folder() -> Path:
    """Return a new, empty folder."""
    return Path(tempfile.mkdtemp(dir=KEPT().name))
