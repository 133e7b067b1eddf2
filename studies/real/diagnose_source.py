"""A study of real recordings in one process: from the vendor's file to the diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.data.study_recordings import convert_source
from palpate.diagnosis.study_diagnosis import run_diagnosis
from palpate.errors import InputError


def diagnose_source(study: Study, report: Callable[[str], None]) -> tuple[dict[str, Any], pd.DataFrame]:
    """Convert the study's vendor file, and diagnose the recordings.

    Returns
    -------
    content, curves
        As `palpate.diagnosis.study_diagnosis.run_diagnosis` does.

    Raises
    ------
    InputError
        When the study names no vendor's file.
    """
    if not study.source:
        raise InputError("names no vendor's file", remedy="add a section source", file=study.file, place="source")
    recordings = study.source["recordings"]
    convert_source(study, study.recordings[recordings])
    return run_diagnosis(study, recordings, report=report)
