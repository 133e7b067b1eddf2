"""The first stage of a calibration: the thesis' genetic search on surrogates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from palpate.errors import InputError
from palpate.inference.genetic import Evaluate, Evolution, GeneticSettings, evolve
from palpate.inference.measures import OBJECTIVES, check_measurable
from palpate.inference.observation import Observation
from palpate.inference.surrogate_space import Space


class Predictor(Protocol):
    """What a surrogate must offer."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Return the curves (n, n_points) at parameters (n, p)."""

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return the slope (n_points, p) of the curve at parameters (p,)."""


@dataclass(frozen=True, eq=False)
class GeneticOptimum:
    """What a genetic search found.

    Attributes
    ----------
    space
        The parameters, within the bounds of the surrogates.
    evolution
        The last generation's front, and its history.
    """

    space: Space
    evolution: Evolution

    @property
    def starts(self) -> list[dict[str, float]]:
        """Parameters at the least sum of objectives, and at the least of each objective."""
        points, objectives = self.evolution.points, self.evolution.objectives
        best = int(np.argmin(objectives.sum(axis=1)))
        others = sorted({int(i) for i in objectives.argmin(axis=0)} - {best})
        return [self.space.named(points[i]) for i in (best, *others)]

    @property
    def values(self) -> dict[str, float]:
        """Parameters at the least sum of objectives."""
        return self.starts[0]

    @property
    def evaluations(self) -> int:
        """Evaluations of the surrogates."""
        return int(self.evolution.history[-1]["evaluations"])

    def curves(self, surrogates: Mapping[str, Predictor]) -> dict[str, np.ndarray]:
        """Return the curves (n_points,) of surrogates at the optimum."""
        x = np.array([list(self.values.values())])
        return {name: surrogate.predict(x)[0] for name, surrogate in surrogates.items()}

    def front(self, names: list[str]) -> dict[str, dict[str, list[float]]]:
        """Return the Pareto front: parameters in their units, and objectives by `names`."""
        points, objectives = self.space.physical(self.evolution.points), self.evolution.objectives
        return {
            "parameters": {name: points[:, i].tolist() for i, name in enumerate(self.space.bounds)},
            "objectives": {name: objectives[:, i].tolist() for i, name in enumerate(names)},
        }


def genetic_search(
    surrogates: Mapping[str, Predictor],
    observations: Mapping[str, Observation],
    bounds: Mapping[str, tuple[float, float]],
    rng: np.random.Generator,
    settings: GeneticSettings,
    objective: str,
    aggregated: bool,
) -> GeneticOptimum:
    """Search for the least objectives of the mean curves on surrogates.

    Parameters
    ----------
    surrogates
        Predictor of each condition; columns in the order of `bounds`.
    observations
        What was measured under each condition.
    bounds
        (lower, upper) of each parameter in its unit; equal bounds hold it.
    rng
        Source of all randomness.
    settings
        Numbers of the search.
    objective, aggregated
        As in `palpate.inference.calibrate.CalibrationSettings`.

    Raises
    ------
    InputError
        When nothing is to be calibrated, a surrogate is missing, shapes disagree, there are fewer points than
        parameters, or the relative objective meets a depth that is not positive.
    """
    space = Space(bounds)
    _check_consistent(space, surrogates, observations, objective)
    evaluate = _objectives(space, surrogates, observations, objective, aggregated)
    return GeneticOptimum(space, evolve(evaluate, space.dimensions, settings, rng))


def _check_consistent(
    space: Space, surrogates: Mapping[str, Predictor], observations: Mapping[str, Observation], objective: str
) -> None:
    if not observations:
        raise InputError("no condition has the role calibrate", remedy="give at least one", place="conditions")
    for name, item in observations.items():
        check_measurable(name, item.mean, objective)
        if name not in surrogates:
            raise InputError(f"condition {name} has no surrogate", remedy="fit one", place=name)
        predicted = surrogates[name].predict(space.physical(np.full(space.dimensions, 0.5))).shape[1]
        if predicted != len(item.time):
            raise InputError(
                f"condition {name} was measured at {len(item.time)} points, its surrogate has {predicted}",
                remedy="resample the recordings on the sample times of the snapshots",
                place=name,
            )
    points = sum(len(item.time) for item in observations.values())
    if points < space.dimensions:
        raise InputError(
            f"{points} points cannot fix {space.dimensions} parameters", remedy="give more points or hold parameters"
        )


def _objectives(
    space: Space,
    surrogates: Mapping[str, Predictor],
    observations: Mapping[str, Observation],
    objective: str,
    aggregated: bool,
) -> Evaluate:
    """Return what gives a generation (n, k) its objectives (n, m): one for each condition, or their sum.

    Loads count as depths, by `palpate.study.quantity.Quantity.nm`, so that the sum is one of like with like.
    """
    measure = OBJECTIVES[objective]
    measured = {name: (item.mean, item.quantity.nm) for name, item in observations.items()}

    def evaluate(u: np.ndarray) -> np.ndarray:
        x = space.physical(u)
        columns = np.column_stack(
            [measure(nm * mean, nm * surrogates[name].predict(x)) for name, (mean, nm) in measured.items()]
        )
        return columns.sum(axis=1, keepdims=True) if aggregated else columns

    return evaluate
