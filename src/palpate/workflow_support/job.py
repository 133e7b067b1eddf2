"""A job of the workflow: its study, a log of how it ended, and one line for an error of the input."""

from __future__ import annotations

import contextlib
import sys
import time
import traceback
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from palpate.configuration.study_file import Study, study_from
from palpate.errors import InputError, PalpateError, of_system
from palpate.workflow_support.result_files import seal, unseal

COMMAND_LINE = ("quick", "reference")  # what --config takes beside keys of a study
CONFIGURATION = "configuration of the workflow"
BOOLEAN = {"true": True, "1": True, "false": False, "0": False}


def study(snakemake: Any) -> Study:
    """Return the study of a script, from the workflow's configuration."""
    return study_from(plain(snakemake.config), CONFIGURATION)


def plain(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the part of a configuration that describes a study.

    What is only for the command line is left out, and the place of vendors' files where the study at hand has none.
    """
    apart = COMMAND_LINE if "source" in config else (*COMMAND_LINE, "data")
    return {key: value for key, value in config.items() if key not in apart}


def boolean(key: str, value: Any) -> bool:
    """Return whether a key of the command line is true; without a value it is not. Snakemake reads ``false`` as text.

    Raises
    ------
    InputError
        When the value is none of `BOOLEAN`.
    """
    text = "false" if value is None else str(value).lower()
    if text not in BOOLEAN:
        raise InputError(f"{key}={value} is neither true nor false", remedy=f"give {key}=true or {key}=false")
    return BOOLEAN[text]


@contextmanager
def logged(path: str | Path, results: Iterable[str] = (), rule: str = "") -> Iterator[None]:
    """Do a job with an empty log at `path`, and write to its end how long it took or why it failed.

    Parameters
    ----------
    results
        Files that it makes, of which checksums are kept, see `palpate.workflow_support.result_files`.
    rule
        The name of its rule.

    Raises
    ------
    SystemExit
        With one line, when palpate or the system refuses, or cannot go on; anything else is raised as it is.
    """
    began, log = time.perf_counter(), Path(path)
    try:
        unseal(log)
        log.write_text("", encoding="utf-8")
        yield
        seal(log, results, rule)
    except (PalpateError, OSError, MemoryError) as error:
        line = f"palpate: {error if isinstance(error, PalpateError) else of_system(error)}"
        with contextlib.suppress(OSError):  # the disk may be full
            note(log, line)
        sys.exit(line)
    except Exception:
        note(log, traceback.format_exc())
        raise
    note(log, f"done in {time.perf_counter() - began:.1f} s")


def note(log: str | Path, text: str) -> None:
    """Add a line to the log of a job."""
    with Path(log).open("a", encoding="utf-8") as file:
        print(text, file=file)
