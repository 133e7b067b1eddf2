"""A study diagnosed in one process: whether the law explains the recordings, and which effects are missing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from palpate.configuration.study_file import Study
from palpate.diagnosis.study_diagnosis import diagnosed
from palpate.errors import InputError
from palpate.notebook.calibrated_study import CalibratedStudy, calibrate, silent
from palpate.notebook.notebook_study import NotebookStudy, study_of
from palpate.notebook.shown import Shown, composed
from palpate.notebook.study_tests import Given, StudyTests
from palpate.output import diagnosis_page
from palpate.output.figures import explained_curves
from palpate.study.protocol import Protocol
from palpate.workflow_support.check_study import check_diagnosis


@dataclass(frozen=True, eq=False, repr=False)
class DiagnosedStudy(Shown):
    """What a diagnosis found.

    Parameters
    ----------
    study
    tests
        The recordings that were diagnosed.
    content
        What ``diagnosis.json`` holds.
    curves
        Recorded curves beside those of the base model (before) and of the best explanation (after).
    """

    study: NotebookStudy
    tests: StudyTests
    content: Mapping[str, Any]
    curves: pd.DataFrame

    @property
    def verdict(self) -> str:
        """``adequate``, ``identified``, ``suspected``, ``ambiguous`` or ``unexplained``."""
        return str(self.content["verdict"])

    @property
    def mechanisms(self) -> list[str]:
        """Keys of the identified effects; empty unless the verdict is ``identified``."""
        return list(self.content["mechanisms"])

    @property
    def tried(self) -> pd.DataFrame:
        """Every explanation that was fitted, best first: mechanisms, log_evidence, p_value, rmse_nm, accepted."""
        base: list[list[str]] = [[]] if self.verdict == "adequate" else []
        accepted = base + [candidate["mechanisms"] for candidate in self.content["candidates"]]
        return pd.DataFrame(
            {
                "mechanisms": " + ".join(entry["mechanisms"]) or "base model",
                **{key: entry[key] for key in ("log_evidence", "p_value", "rmse_nm")},
                "accepted": entry["mechanisms"] in accepted,
            }
            for entry in self.content["tried"]
        )

    def to_frame(self) -> pd.DataFrame:
        """Return the candidates, one row a parameter of their mechanisms, best first; empty where there is none.

        Returns
        -------
        DataFrame
            explanation, probability, parameter, unit, estimate, lower and upper (95 % interval).
        """
        return diagnosis_page.explanations(self.content)

    def _sentences(self) -> list[str]:
        return [self.content["sentence"], *self.content["limits"]]

    def _tables(self) -> list[pd.DataFrame]:
        candidates = self.to_frame()
        return [candidates, self.tried] if len(candidates) else [self.tried]

    def plot(self, ax: Axes | None = None) -> Axes | np.ndarray:
        """Draw what was found.

        Parameters
        ----------
        ax
            Axes on which the evidence of each explanation is drawn. When not given, a figure is made of where the base
            model fails, that evidence, and the misfit in time before and after.

        Returns
        -------
        Axes or ndarray of Axes, shape (n,)
            `ax`, or the axes of the figure.
        """
        if ax is not None:
            explained_curves.evidence(ax, self.content)
            return ax
        title, synthetic = self.study.title, self.tests.synthetic
        return composed(lambda figure: explained_curves.compose(figure, self.content, self.curves, title, synthetic))

    def __repr__(self) -> str:
        named = f", {' + '.join(self.mechanisms)}" if self.mechanisms else ""
        return f"<DiagnosedStudy {self.study.name!r}, recordings {self.tests.name!r}: {self.verdict}{named}>"


def diagnose(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    calibration: CalibratedStudy | None = None,
    *,
    results: str | Path | None = None,
    report: Callable[[str], None] | None = None,
) -> DiagnosedStudy:
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
    DiagnosedStudy

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
        tests = calibration.tests
    elif not isinstance(calibration, CalibratedStudy):
        problem = f"{type(calibration).__name__} is no calibration of a study"
        raise InputError(problem, remedy="give what calibrate returns, or leave it out", place="calibration")
    else:
        _check_same(chosen, calibration.study)
        tests = calibration.tests if recordings is None else StudyTests.of(chosen, recordings)
    content, curves = diagnosed(chosen, tests.by_condition, calibration.values, report or silent)
    return DiagnosedStudy(chosen, tests, content | {"recordings": tests.name}, curves)


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
