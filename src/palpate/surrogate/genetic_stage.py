"""The first stage of a calibration: the thesis' genetic search on surrogates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palpate.configuration.settings import CalibrationSettings
from palpate.data.measures import OBJECTIVES, check_measurable
from palpate.data.observation import Observation
from palpate.errors import InputError
from palpate.surrogate.genetic import Evaluate, Evolution, evolve
from palpate.surrogate.surrogates import Surrogates


@dataclass(frozen=True, eq=False)
class GeneticOptimum:
    """What a genetic search found.

    Attributes
    ----------
    model
        The surrogates, within their bounds.
    evolution
        The last generation's front, and its history.
    """

    model: Surrogates
    evolution: Evolution

    @property
    def starts(self) -> list[dict[str, float]]:
        """Parameters at the least sum of objectives, and at the least of each objective."""
        others = sorted({int(i) for i in self.evolution.objectives.argmin(axis=0)} - {self._best})
        return [self.model.named(self.evolution.points[i]) for i in (self._best, *others)]

    @property
    def values(self) -> dict[str, float]:
        """Parameters at the least sum of objectives."""
        return self.starts[0]

    @property
    def evaluations(self) -> int:
        """Evaluations of the surrogates."""
        return int(self.evolution.history[-1]["evaluations"])

    @property
    def _best(self) -> int:
        return int(np.argmin(self.evolution.objectives.sum(axis=1)))

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """Curves (n_points,) of the surrogates at the least sum of objectives."""
        (found,) = self.model.at(self.evolution.points[[self._best]])
        return found

    def front(self, names: list[str]) -> dict[str, dict[str, list[float]]]:
        """Return the Pareto front: parameters in their units, and objectives by `names`."""
        points, objectives = self.model.parameters(self.evolution.points), self.evolution.objectives
        return {
            "parameters": {name: points[:, i].tolist() for i, name in enumerate(self.model.bounds)},
            "objectives": {name: objectives[:, i].tolist() for i, name in enumerate(names)},
        }


def genetic_search(
    model: Surrogates,
    observations: Mapping[str, Observation],
    rng: np.random.Generator,
    settings: CalibrationSettings,
) -> GeneticOptimum:
    """Search for the least objectives of the mean curves on surrogates.

    Parameters
    ----------
    model
        Surrogates of each condition.
    observations
        What was measured under each condition.
    rng
        Source of all randomness.
    settings
        Numbers and objective of the search.

    Raises
    ------
    InputError
        When nothing is to be calibrated, a surrogate is missing, shapes disagree, there are fewer points than
        parameters, or the relative objective meets a depth that is not positive.
    """
    _check_consistent(model, observations, settings.objective)
    evaluate = _objectives(model, observations, settings.objective, settings.aggregated)
    return GeneticOptimum(model, evolve(evaluate, len(model.free), settings, rng))


def _check_consistent(model: Surrogates, observations: Mapping[str, Observation], objective: str) -> None:
    if not observations:
        raise InputError("no condition has the role calibrate", remedy="give at least one", place="conditions")
    for name, item in observations.items():
        check_measurable(name, item.mean, objective)
        if name not in model.predictors:
            raise InputError(f"condition {name} has no surrogate", remedy="fit one", place=name)
        middle = model.parameters(np.full((1, len(model.free)), 0.5))
        predicted = model.predictors[name].predict(middle).shape[1]
        if predicted != len(item.time):
            raise InputError(
                f"condition {name} was measured at {len(item.time)} points, its surrogate has {predicted}",
                remedy="resample the recordings on the sample times of the snapshots",
                place=name,
            )
    points = sum(len(item.time) for item in observations.values())
    if points < (free := len(model.free)):
        raise InputError(f"{points} points cannot fix {free} parameters", remedy="give more points or hold parameters")


def _objectives(
    model: Surrogates, observations: Mapping[str, Observation], objective: str, aggregated: bool
) -> Evaluate:
    """Return what gives a generation (n, k) its objectives (n, m): one for each condition, or their sum.

    All count as depths, by `palpate.observables.observable.Quantity.nm`, so that the sum is one of like with like.
    """
    measure = OBJECTIVES[objective]
    measured = {name: (item.mean, item.quantity.nm) for name, item in observations.items()}

    def evaluate(u: np.ndarray) -> np.ndarray:
        x = model.parameters(u)
        columns = np.column_stack(
            [measure(nm * mean, nm * model.predictors[name].predict(x)) for name, (mean, nm) in measured.items()]
        )
        return columns.sum(axis=1, keepdims=True) if aggregated else columns

    return evaluate
