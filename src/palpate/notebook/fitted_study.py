"""A study calibrated and diagnosed in one process: snapshots, surrogates, and searches on the finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

from palpate.configuration.study_file import Study
from palpate.data.study_recordings import resampled
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.study_diagnosis import diagnosed
from palpate.errors import InputError
from palpate.notebook.notebook_study import study_of
from palpate.notebook.session import kept_results
from palpate.notebook.study_tests import Given, given_tests
from palpate.output.results.calibration import Calibration
from palpate.output.results.diagnosis import Diagnosis
from palpate.output.saved_set import ALL, SavedSet
from palpate.workflow_support.check_study import (
    check_calibration,
    check_diagnosis,
    check_objective,
    check_same_model,
)
from palpate.workflow_support.steps import calibrate_study, curves_beside, simulated_surrogates

Report = Callable[[str], None]


def silent(line: str) -> None:
    """Drop a line on the progress."""


def calibrate(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    *,
    results: str | Path | None = None,
    report: Report = silent,
) -> Calibration:
    """Calibrate the parameters of a study's law on recordings.

    The snapshots are simulated, POD-RBF surrogates fitted to them and searched by a genetic algorithm, and least
    squares continue from there on the finite elements themselves; docs/inference.md explains how, and the intervals.

    Parameters
    ----------
    study
        A study, a mapping with the keys of one, or its YAML file.
    recordings
        The name of a set of the study; None for the only one that it has; or tests by the name of their condition, as
        files, as `read_recording` or `simulate` return them, or as `indentation_files.recording.Recording`. Of a
        study with a single condition tests may be given as they are.
    results
        Folder in whose ``store`` simulated curves are kept and looked for, such as ``results`` of the workflow; when
        not given, they are kept until Python ends.
    report
        Called with one line on the progress, such as ``print``.

    Returns
    -------
    palpate.output.results.calibration.Calibration

    Raises
    ------
    InputError
        When the study or a recording is invalid.
    PalpateError
        When too many simulations fail.
    """
    chosen = study_of(study)
    check_calibration(chosen)
    name, tests = given_tests(chosen, recordings)
    observed = resampled(chosen, tests)
    check_objective(chosen, observed)
    store = (kept_results() if results is None else Path(results)) / "store"
    models = simulated_surrogates(chosen, store, report)
    report("step 3 of 3: search and least squares")
    found = calibrate_study(chosen, models, observed, report)
    content = found.to_mapping(study=chosen.name, recordings=name, condition_set=ALL)
    curves = curves_beside(chosen, observed, found, report)
    return Calibration(SavedSet(chosen, name, tests, {ALL: content}, {ALL: curves}))


def diagnose(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    calibration: Calibration | None = None,
    *,
    results: str | Path | None = None,
    report: Report = silent,
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
    results, report
        As for `calibrate`.

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
    content, curves = diagnosed(chosen, by_condition, calibration.content, _numbered(report))
    return Diagnosis(replace(saved, diagnosis=content | {"recordings": saved.name}, explained=curves))


def _numbered(report: Report) -> Report:
    """Return a `report` whose lines on explanations that were fitted say how many there were, of how many at most."""
    number, most = count(1), SearchPolicy().most

    def reported(line: str) -> None:
        report(f"explanation {next(number)} of at most {most}, {line}" if ": expected " in line else line)

    return reported
