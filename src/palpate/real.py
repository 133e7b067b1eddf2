"""A study of real recordings in one process: from the vendor's file to the diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import joblib
import pandas as pd

from palpate import snapshots
from palpate.config import Study
from palpate.diagnosis import design
from palpate.diagnosis.effects import fit_effects
from palpate.diagnosis.steps import run_diagnosis
from palpate.errors import InputError
from palpate.observations import convert_source
from palpate.steps import fit_surrogate


def diagnose_source(
    study: Study, results: Path = Path("results"), report: Callable[[str], None] = print
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Convert the study's vendor file, simulate what the store lacks, and diagnose the recordings.

    Returns
    -------
    content, curves
        As `palpate.diagnosis.steps.run_diagnosis` does.

    Raises
    ------
    InputError
        When the study names no vendor's file.
    """
    if not study.source:
        raise InputError("names no vendor's file", remedy="add a section source", file=study.file, place="source")
    recordings, folder = study.source["recordings"], results / study.name
    convert_source(study, study.recordings[recordings])
    plans = snapshots.plan(study, results), design.plan(study, results)
    for batch in (*plans[0], *plans[1]):
        snapshots.compute(batch, results, report)
    base, effects = {}, {}
    for condition in study.conditions:
        if condition.role == "calibrate":
            files = [file for batch in plans[0] for file in batch.under(condition.name)]
            model, _, _, summary = fit_surrogate(study, files)
            fitted = fit_effects(study, condition, folder / "effects" / condition.name)
            report(f"{condition.name}: leave-one-out error of the surrogate {summary['loo_rmse_nm']:.2g} nm")
            base[condition.name] = folder / f"{condition.name}.surrogate.joblib"
            effects[condition.name] = folder / f"{condition.name}.effects.joblib"
            joblib.dump(model, base[condition.name])
            joblib.dump(fitted, effects[condition.name])
    return run_diagnosis(study, recordings, base, effects, report)
