"""A study of real recordings in one process: from the vendor's file to the diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.diagnosis.study_diagnosis import optimum_on_surrogates, run_diagnosis
from palpate.errors import InputError
from palpate.inference.study_recordings import convert_source, observations
from palpate.solver import store
from palpate.workflow_support.steps import fit_surrogate


def diagnose_source(
    study: Study, results: Path = Path("results"), report: Callable[[str], None] = print
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Convert the study's vendor file, simulate what the store lacks, and diagnose the recordings.

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
    recordings, surrogates = study.source["recordings"], {}
    convert_source(study, study.recordings[recordings])
    for condition in [condition.name for condition in study.conditions if condition.role == "calibrate"]:
        contents = store.computed(store.snapshots_under(study, condition), results / "store", report)
        surrogates[condition], _, _, summary = fit_surrogate(study, condition, contents)
        report(f"{condition}: leave-one-out error of the surrogate {summary['loo_rmse_nm']:.2g} nm")
    start = optimum_on_surrogates(study, observations(study, recordings), surrogates)
    return run_diagnosis(study, recordings, [start], report)
