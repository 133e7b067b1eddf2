"""A job of the workflow: its log tells how it ended, and what palpate refuses ends it with one line."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from palpate.errors import PalpateError


@contextmanager
def logged(path: str | Path) -> Iterator[None]:
    """Do a job with an empty log at `path`, and write to its end how long it took or why it failed.

    Raises
    ------
    SystemExit
        With one line, when palpate refuses or cannot go on; anything else is raised as it is.
    """
    began, log = time.perf_counter(), Path(path)
    log.write_text("", encoding="utf-8")
    try:
        yield
    except PalpateError as error:
        _note(log, f"palpate: {error}")
        sys.exit(f"palpate: {error}")
    except Exception:
        _note(log, traceback.format_exc())
        raise
    _note(log, f"done in {time.perf_counter() - began:.1f} s")


def _note(log: Path, words: str) -> None:
    with log.open("a", encoding="utf-8") as file:
        print(words, file=file)
