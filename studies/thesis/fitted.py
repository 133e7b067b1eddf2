"""What a study fitted, for MLflow: a surrogate with its snapshots, or the outcome of any other fit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.inference.calibration_result import CalibrationOutcome
from palpate.surrogate import PODRBF
from palpate.surrogate.saved import save
from palpate.workflow_support.run_records import Run, calibration_metrics


def beside_truth(found: CalibrationOutcome, truth: Mapping[str, float], names: Iterable[str]) -> list[dict[str, Any]]:
    """Return estimate, interval and truth of some parameters, a row each."""
    return [
        {
            "parameter": name,
            "truth": truth[name],
            "estimate": entry.estimate,
            "lower": entry.lower,
            "upper": entry.upper,
            "identified": entry.identified,
            "at_bound": entry.at_bound,
            "holds_truth": entry.lower <= truth[name] <= entry.upper,
        }
        for name, entry in ((name, found.parameters[name]) for name in names)
    ]


@dataclass(frozen=True, eq=False)
class Fitted:
    """One fit.

    Parameters
    ----------
    name
        Of its run.
    kind
        ``surrogate``, ``calibration`` or ``fit``.
    settings
        How it was fitted, by name.
    metrics
        What came out, by name.
    series
        What came out of repeated fits, such as one value a seed.
    model, parameters, curves
        A surrogate to be kept, and the snapshots (n, p) and (n, points) it was fitted to.
    calibration
        The content of a calibration's JSON.
    """

    name: str
    kind: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    metrics: Mapping[str, float] = field(default_factory=dict)
    series: Mapping[str, Sequence[float]] = field(default_factory=dict)
    model: PODRBF | None = None
    parameters: np.ndarray | None = None
    curves: np.ndarray | None = None
    calibration: Mapping[str, Any] | None = None

    @classmethod
    def surrogate(cls, name: str, model: PODRBF, parameters: np.ndarray, curves: np.ndarray) -> Fitted:
        """Return a surrogate to be kept, with its leave-one-out error."""
        metrics = {
            "snapshots": float(len(curves)),
            "modes": float(model.n_modes_),
            "shape": float(model.shape_),
            "condition_number": float(model.condition_number_),
            "surrogate_nm": float(np.sqrt(np.mean(model.loo_error_**2))),
        }
        return cls(name, "surrogate", metrics=metrics, model=model, parameters=parameters, curves=curves)

    @classmethod
    def row(cls, name: str, kind: str, row: Mapping[str, Any]) -> Fitted:
        """Return a fit from a row of a table: its words are settings, its numbers metrics."""
        metrics = {key: float(value) for key, value in row.items() if isinstance(value, int | float)}
        return cls(name, kind, {key: value for key, value in row.items() if isinstance(value, str)}, metrics)

    @classmethod
    def of_calibration(cls, name: str, found: CalibrationOutcome, **about: str) -> Fitted:
        """Return a calibration."""
        return cls(name, "calibration", settings=dict(found.settings), calibration=found.to_mapping(**about))

    def run(self, folder: Path, thesis_study: str) -> Run:
        """Return its record for MLflow; a surrogate is kept in `folder`."""
        tags = {"thesis_study": thesis_study}
        if self.calibration is not None:
            return Run(self.name, self.kind, tags, dict(self.settings), calibration_metrics(self.calibration))
        series = {key: list(map(float, values)) for key, values in self.series.items()}
        found = Run(self.name, self.kind, tags, dict(self.settings), dict(self.metrics), series)
        if self.model is None or self.parameters is None or self.curves is None:
            return found
        file = folder / f"{self.name.replace(' ', '_')}.npz"
        save(self.model, self.parameters, self.curves, file)
        found.params |= self.model.get_params()
        found.series["by_point.loo_rms_nm"] = self.model.loo_rms_.tolist()
        return replace(found, surrogate=str(file), model=self.name)
