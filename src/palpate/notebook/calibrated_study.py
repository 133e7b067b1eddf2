"""A study calibrated in one process: snapshots, surrogates, genetic search, least squares on the finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from palpate.configuration.study_file import Study
from palpate.inference.calibration_result import Calibration
from palpate.inference.study_recordings import resampled
from palpate.notebook.notebook_study import NotebookStudy, study_of
from palpate.notebook.session import kept_results
from palpate.notebook.shown import Shown, axes_for, composed
from palpate.notebook.study_tests import Given, StudyTests
from palpate.output import html_report
from palpate.output.figures import fitted_curves
from palpate.solver import store
from palpate.surrogate import PODRBF
from palpate.workflow_support.check_study import check_calibration, check_objective
from palpate.workflow_support.steps import calibrate_study, curves_beside, error_table, fit_surrogate


@dataclass(frozen=True, eq=False, repr=False)
class CalibratedStudy(Shown):
    """What a calibration found.

    Parameters
    ----------
    study
    tests
        The recordings that it was calibrated on.
    calibration
        The outcome in full.
    curves
        Recorded, surrogates' and simulated curves of all conditions, see
        `palpate.workflow_support.steps.run_calibration`.
    """

    study: NotebookStudy
    tests: StudyTests
    calibration: Calibration
    curves: pd.DataFrame

    @property
    def values(self) -> dict[str, float]:
        """Estimates by the names of the parameters."""
        return self.calibration.values

    @property
    def errors(self) -> pd.DataFrame:
        """One row a condition: role, root mean square error, R^2, mean absolute error, error in per cent."""
        return error_table(self.calibration.to_mapping())

    def to_frame(self) -> pd.DataFrame:
        """Return one row a parameter.

        Returns
        -------
        DataFrame
            parameter, unit, estimate, lower and upper (95 % interval), identified (whether the data determine it),
            held, at_bound, outside (whether it lies beyond its range).
        """
        declared = self.study.declared
        return pd.DataFrame(
            {"parameter": name, "unit": declared[name].unit, **vars(found)}
            for name, found in self.calibration.parameters.items()
        )

    def _tables(self) -> list[pd.DataFrame]:
        return [self.to_frame()[["parameter", "unit", "estimate", "lower", "upper", "identified"]], self.errors]

    def _sentences(self) -> list[str]:
        content = self.calibration.to_mapping()
        sentences = (html_report.misfit_sentence, html_report.bound_sentence, html_report.convergence_sentence)
        return [text for sentence in sentences if (text := sentence(content))]

    def plot(self, ax: Axes | None = None) -> Axes | np.ndarray:
        """Draw recorded and simulated curves.

        Parameters
        ----------
        ax
            Axes on which the curves of all conditions are drawn together. When not given, a figure is made with two
            panels a condition, curves above and misfit in time below.

        Returns
        -------
        Axes or ndarray of Axes, shape (n,)
            `ax`, or the axes of the figure.
        """
        if ax is not None:
            fitted_curves.together(axes_for(ax), self.curves)
            return ax
        title = f"{self.study.title}: {self.study.model}"
        return composed(lambda figure: fitted_curves.compose(figure, self.curves, title, self.tests.synthetic))

    def __repr__(self) -> str:
        known = [found for found in self.calibration.parameters.values() if not found.held]
        fixed = sum(found.identified for found in known)
        return (
            f"<CalibratedStudy {self.study.name!r}, recordings {self.tests.name!r}: {fixed} of {len(known)} parameters "
            "identified>"
        )


def calibrate(
    study: Study | Mapping[str, Any] | str | Path,
    recordings: Given = None,
    *,
    results: str | Path | None = None,
    report: Callable[[str], None] | None = None,
) -> CalibratedStudy:
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
    CalibratedStudy

    Raises
    ------
    InputError
        When the study or a recording is invalid.
    PalpateError
        When too many simulations fail.
    """
    chosen, report = study_of(study), report or silent
    check_calibration(chosen)
    tests = StudyTests.of(chosen, recordings)
    observed = resampled(chosen, tests.by_condition)
    check_objective(chosen, observed)
    models = _surrogates(chosen, kept_results() if results is None else Path(results), report)
    found = calibrate_study(chosen, models, observed, report)
    return CalibratedStudy(chosen, tests, found, curves_beside(chosen, observed, found, report))


def _surrogates(study: Study, results: Path, report: Callable[[str], None]) -> dict[str, PODRBF]:
    """Return the surrogate of each condition that calibrates; those of its snapshots that are missing are simulated."""
    contents: dict[str, list[dict[str, Any]]] = {}
    for batch in store.plan(study):
        found = store.computed(batch.snapshots, results / "store", report)
        for snapshot, content in zip(batch.snapshots, found, strict=True):
            contents.setdefault(snapshot.condition, []).append(content)
    models = {}
    for name, curves in contents.items():
        models[name], _, _, summary = fit_surrogate(study, name, curves)
        if summary["missing"]:
            report(summary["missing"])
    return models


def silent(line: str) -> None:
    """Drop a line on the progress."""
