"""Reading the saved results of a study: those of each set of recordings, as figures, report and MLflow show them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.data.study_recordings import check
from palpate.errors import InputError
from palpate.output.saved_set import SavedSet
from palpate.workflow_support.result_files import read_json


def saved_sets(study: Study, folder: Path) -> list[SavedSet]:
    """Return the results of each set of recordings of a study.

    Parameters
    ----------
    folder
        Such as ``results/STUDY``.

    Raises
    ------
    InputError
        When a file is missing; it says which.
    """
    for file in needed(study, folder):
        if not file.is_file():
            raise InputError("is missing", remedy="run the study first: palpate run STUDY.yaml", file=file)
    summaries = {c.name: read_json(folder / "surrogates" / f"{c.name}.json") for c in study.calibrated}
    sets = []
    for name in study.recordings:
        found = folder / name
        calibrations = {key: read_json(found / "calibrations" / f"{key}.json") for key in study.condition_sets}
        fits = {key: pd.read_csv(found / "calibrations" / f"{key}.curves.csv") for key in study.condition_sets}
        diagnosed = study.diagnosis.enabled
        sets.append(
            SavedSet(
                study,
                name,
                check(study, name),
                calibrations,
                fits,
                read_json(found / "diagnosis.json") if diagnosed else None,
                pd.read_csv(found / "diagnosis.curves.csv") if diagnosed else None,
                summaries,
                study.laboratory[name].parameters if name in study.laboratory else {},
            )
        )
    return sets


def needed(study: Study, folder: Path) -> Iterator[Path]:
    """Yield the files that results are read from."""
    yield from (folder / "surrogates" / f"{condition.name}.json" for condition in study.calibrated)
    for name in study.recordings:
        for key in study.condition_sets:
            yield from (folder / name / "calibrations" / f"{key}{end}" for end in (".json", ".curves.csv"))
        if study.diagnosis.enabled:
            yield from (folder / name / f"diagnosis{end}" for end in (".json", ".curves.csv"))
