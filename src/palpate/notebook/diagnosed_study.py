"""A study diagnosed in one process: whether the law explains the recordings, and which effects are missing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.configuration.study_file import Study
from palpate.diagnosis.study_diagnosis import diagnosed
from palpate.errors import InputError
from palpate.notebook.calibrated_study import calibrate, silent
from palpate.notebook.notebook_study import study_of
from palpate.notebook.study_tests import Given, given_tests
from palpate.output.results.calibration import Calibration
from palpate.output.results.diagnosis import Diagnosis
from palpate.workflow_support.check_study import check_diagnosis, check_same_model


def diagnose(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    calibration: Calibration | None = None,
    *,
    results: str | Path | None = None,
    report: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Test whether the law of a study explains recordings to their noise, and search for the effects that are missing.

    docs/evidence.md explains how. The study's key ``diagnosis.enabled`` is for the workflow only.

    Parameters
    ----------
    study
        A study, a mapping with the keys of one, or its YAML file.
    recordings
        As for `calibrate`; when not given, those of the calibration, or else the only set of the study.
    calibration
        From which the diagnosis starts; when not given, the study is calibrated first.
    results
        As for `calibrate`.
    report
        Called with one line on the progress, such as ``print``; silent when not given.

    Returns
    -------
    palpate.output.results.diagnosis.Diagnosis

    Raises
    ------
    InputError
        When the study or a recording is invalid, or the calibration is of other parameters, another law or tip, other
        kinematics, fixed values or conditions.
    PalpateError
        When the forward model fails wherever a search may begin.
    """
    chosen = study_of(study)
    check_diagnosis(chosen)
    if calibration is None:
        calibration = calibrate(chosen, recordings, results=results, report=report)
    elif not isinstance(calibration, Calibration):
        problem = f"{type(calibration).__name__} is no calibration of a study"
        raise InputError(problem, remedy="give what calibrate returns, or leave it out", place="calibration")
    else:
        check_same_model(chosen, calibration.study)
    saved = replace(calibration.saved, study=chosen)
    if recordings is not None:
        name, tests = given_tests(chosen, recordings)
        saved = replace(saved, name=name, tests=tests)
    by_condition = {name: list(tests) for name, tests in saved.tests.items()}
    content, curves = diagnosed(chosen, by_condition, calibration.values, report or silent)
    return Diagnosis(replace(saved, diagnosis=content | {"recordings": saved.name}, explained=curves))
