"""A study calibrated in one process: snapshots, surrogates, genetic search, least squares on the finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from palpate.configuration.study_file import Study
from palpate.data.study_recordings import resampled
from palpate.notebook.notebook_study import study_of
from palpate.notebook.session import kept_results
from palpate.notebook.study_tests import Given, given_tests
from palpate.output.results.calibration import Calibration
from palpate.output.saved_set import ALL, SavedSet
from palpate.solver import store
from palpate.surrogate import PODRBF
from palpate.workflow_support.check_study import check_calibration, check_objective
from palpate.workflow_support.steps import calibrate_study, curves_beside, fit_surrogate


def calibrate(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    *,
    results: str | Path | None = None,
    report: Callable[[str], None] | None = None,
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
        files, as `read_recording` or `simulate` return them, or as `palpate.recordings.recording.Recording`. Of a
        study with a single condition tests may be given as they are.
    results
        Folder in whose ``store`` simulated curves are kept and looked for, such as ``results`` of the workflow; when
        not given, they are kept until Python ends.
    report
        Called with one line on the progress, such as ``print``; silent when not given.

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
    chosen, report = study_of(study), report or silent
    check_calibration(chosen)
    name, tests = given_tests(chosen, recordings)
    observed = resampled(chosen, tests)
    check_objective(chosen, observed)
    models = _surrogates(chosen, kept_results() if results is None else Path(results), report)
    report("step 3 of 3: search and least squares")
    found = calibrate_study(chosen, models, observed, report)
    content = found.to_mapping(study=chosen.name, recordings=name, condition_set=ALL)
    curves = curves_beside(chosen, observed, found, report)
    return Calibration(SavedSet(chosen, name, tests, {ALL: content}, {ALL: curves}))


def _surrogates(study: Study, results: Path, report: Callable[[str], None]) -> dict[str, PODRBF]:
    """Return the surrogate of each condition that calibrates; those of its snapshots that are missing are simulated."""
    report("step 1 of 3: snapshots")
    contents: dict[str, list[dict[str, Any]]] = {}
    for batch in store.plan(study):
        found = store.computed(batch.snapshots, results / "store", report)
        for snapshot, content in zip(batch.snapshots, found, strict=True):
            contents.setdefault(snapshot.condition, []).append(content)
    report("step 2 of 3: surrogates")
    models = {}
    for name, curves in contents.items():
        models[name], _, _, summary = fit_surrogate(study, name, curves)
        if summary["missing"]:
            report(summary["missing"])
    return models


def silent(line: str) -> None:
    """Drop a line on the progress."""
