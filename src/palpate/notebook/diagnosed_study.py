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
from palpate.notebook.study_tests import Given, StudyTests
from palpate.output.results.calibration import Calibration
from palpate.output.results.diagnosis import Diagnosis
from palpate.study.protocol import Protocol
from palpate.workflow_support.check_study import check_diagnosis


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
        _check_same(chosen, calibration.study)
    saved = replace(calibration.saved, study=chosen)
    if recordings is not None:
        tests = StudyTests.of(chosen, recordings)
        saved = replace(saved, name=tests.name, tests=tests.by_condition)
    by_condition = {name: list(tests) for name, tests in saved.tests.items()}
    content, curves = diagnosed(chosen, by_condition, calibration.values, report or silent)
    return Diagnosis(replace(saved, diagnosis=content | {"recordings": saved.name}, explained=curves))


def _check_same(study: Study, calibrated: Study) -> None:
    """Refuse the calibration of a study that simulates something else; raises `InputError`."""
    ours, theirs = (", ".join(sorted(each.levels)) for each in (study, calibrated))
    here, there = ({c.name: _history(c.protocol) for c in each.conditions} for each in (study, calibrated))
    other = ", ".join(name for name in {**here, **there} if here.get(name) != there.get(name))
    for differs, what in (
        (ours != theirs, f"{theirs}, the study asks for {ours}"),
        (study.model != calibrated.model, f"the law {calibrated.model}"),
        (study.fixed != calibrated.fixed, "other values under material"),
        (study.indenter != calibrated.indenter, "another indenter"),
        (study.kinematics != calibrated.kinematics, f"{calibrated.kinematics} strains"),
        (here != there, f"other conditions: {other}"),
    ):
        if differs:
            raise InputError(
                f"the calibration is of {what}", remedy="give the calibration of this study, or leave it out",
                place="calibration",
            )  # fmt: skip


def _history(protocol: Protocol) -> tuple[Any, ...]:
    """Return what a protocol prescribes, to be compared."""
    return protocol.control, protocol.compliance, protocol.knot_time.tolist(), protocol.knot_drive.tolist()
