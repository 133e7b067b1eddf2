"""From surrogates and recordings to parameters with intervals, confirmed by the solver itself.

1. A genetic algorithm searches the surrogates, one objective a condition (or their mean).
2. Generalised least squares polishes its best points: residuals are whitened by the covariance of the recordings.
3. The solver runs at the result; what it differs from the surrogate there is added to the surrogate, and 2 is repeated.
   The surrogate's own error thus drops out where it matters.
4. Intervals are profiles of the same least squares: all values of a parameter for which the others can be chosen so
   that the sum of squares rises by less than the 95 % point of chi-square with one degree of freedom (times the reduced
   chi-square where that exceeds one). A parameter counts as identified when its interval is shorter than half of the
   range that was searched.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import chi2

from palpate.calibration.genetic import Evolution, GeneticSettings, evolve
from palpate.calibration.measures import OBJECTIVES, error_table
from palpate.calibration.noise import Observation


class Predictor(Protocol):
    """What a surrogate must offer."""

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Return curves (n, points) [nm] for parameters (n, d)."""

    @property
    def loo_rms_(self) -> np.ndarray:
        """Leave-one-out error at each point [nm]."""


Confirm = Callable[[Mapping[str, float]], dict[str, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Calibration:
    """Outcome of a calibration.

    Attributes
    ----------
    parameters
        Estimate, lower and upper end of the 95 % interval, and whether the data identify it, by name.
    conditions
        Error measures of the solver's curves by condition, with the condition's role.
    simulated
        The solver's curves at the estimate, by condition [nm].
    surrogate
        The surrogates' curves there, for the conditions that have one [nm].
    reduced_chi_square
        Sum of squared whitened residuals over degrees of freedom: near 1 when the model explains the recordings.
    evolution
        The genetic algorithm's run.
    """

    parameters: dict[str, dict[str, Any]]
    conditions: dict[str, dict[str, Any]]
    simulated: dict[str, np.ndarray]
    surrogate: dict[str, np.ndarray]
    reduced_chi_square: float
    evolution: Evolution
    notes: dict[str, Any] = field(default_factory=dict)

    @property
    def estimate(self) -> dict[str, float]:
        """Estimates by name."""
        return {name: entry["estimate"] for name, entry in self.parameters.items()}

    def to_mapping(self) -> dict[str, Any]:
        """Return the content of calibration.json."""
        return {
            "parameters": self.parameters,
            "conditions": self.conditions,
            "reduced_chi_square": self.reduced_chi_square,
            "evaluations": self.evolution.evaluations,
            "generations": self.evolution.history[-1]["generation"],
            **self.notes,
        }


def calibrate(
    surrogates: Mapping[str, Predictor],
    observations: Mapping[str, Observation],
    roles: Mapping[str, str],
    ranges: Mapping[str, tuple[float, float]],
    confirm: Confirm,
    settings: GeneticSettings,
    rng: np.random.Generator,
    *,
    strategy: str = "nsga2",
    objective: str = "squared",
    confirmations: int = 3,
) -> Calibration:
    """Calibrate.

    Parameters
    ----------
    surrogates
        One for each condition that takes part, over all parameters in `ranges`, in that order.
    observations
        Of every condition, those that only judge included.
    roles
        ``calibrate`` or ``validate`` by condition.
    ranges
        Least and largest value of each parameter; equal for one that is held constant.
    confirm
        Runs the solver: parameters by name to curves by condition.
    strategy
        ``nsga2``, one objective a condition, or ``aggregate``, their mean.
    objective
        ``squared`` or ``relative``, see `palpate.calibration.measures`.
    confirmations
        Times that the solver runs, each but the last followed by another polish.
    """
    names = list(ranges)
    lower, upper = (np.array([ranges[name][side] for name in names]) for side in (0, 1))
    free = upper > lower
    measure = OBJECTIVES[objective]

    def complete(x: np.ndarray) -> np.ndarray:
        whole = np.tile(lower, (len(x), 1))
        whole[:, free] = x
        return whole

    def evaluate(x: np.ndarray) -> np.ndarray:
        whole = complete(x)
        errors = [measure(model.predict(whole), observations[name].mean) for name, model in surrogates.items()]
        scores = np.stack(errors, axis=1)
        return scores if strategy == "nsga2" else scores.mean(axis=1, keepdims=True)

    evolution = evolve(evaluate, lower[free], upper[free], settings, rng)
    misfit = Misfit(surrogates, observations, lower[free], upper[free], complete)
    x = misfit.polish(evolution.best)
    for _ in range(confirmations - 1):
        solved = confirm(dict(zip(names, complete(x[None])[0], strict=True)))
        misfit.correct(x, solved)
        x = misfit.polish(x)
    estimate = complete(x[None])[0]
    values = {name: float(value) for name, value in zip(names, estimate, strict=True)}
    solved = confirm(values)
    intervals = iter(misfit.intervals(x))
    parameters = {}
    for name, is_free in zip(names, free, strict=True):
        low, high = next(intervals) if is_free else (values[name], values[name])
        searched = ranges[name][1] - ranges[name][0]
        parameters[name] = {
            "estimate": values[name],
            "lower": low,
            "upper": high,
            "identified": bool(is_free and high - low < 0.5 * searched),
        }
        if not is_free:
            parameters[name]["held"] = True
    return Calibration(
        parameters=parameters,
        conditions={
            name: error_table(solved[name], observation.mean) | {"role": roles[name]}
            for name, observation in observations.items()
        },
        simulated=solved,
        surrogate={name: model.predict(estimate[None])[0] for name, model in surrogates.items()},
        reduced_chi_square=misfit.reduced_chi_square(x),
        evolution=evolution,
        notes={"strategy": strategy, "objective": objective, "confirmed_by": "finite elements"},
    )


class Misfit:
    """Whitened residuals of all conditions, over the parameters that are free."""

    def __init__(
        self,
        surrogates: Mapping[str, Predictor],
        observations: Mapping[str, Observation],
        lower: np.ndarray,
        upper: np.ndarray,
        complete: Callable[[np.ndarray], np.ndarray],
    ):
        self._surrogates, self._lower, self._upper, self._complete = surrogates, lower, upper, complete
        self._means = {name: observations[name].mean for name in surrogates}
        self._whiten = {
            name: np.linalg.inv(np.linalg.cholesky(observations[name].covariance(model.loo_rms_**2)))
            for name, model in surrogates.items()
        }
        self._offsets = {name: np.zeros(len(mean)) for name, mean in self._means.items()}

    def correct(self, x: np.ndarray, solved: Mapping[str, np.ndarray]) -> None:
        """Shift the surrogates so that they meet the solver's curves at `x`."""
        whole = self._complete(x[None])
        for name, model in self._surrogates.items():
            self._offsets[name] = solved[name] - model.predict(whole)[0]

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Return whitened residuals of all conditions at a batch `x` (b, d), shape (b, points of all)."""
        whole = self._complete(x)
        return np.concatenate(
            [
                (model.predict(whole) + self._offsets[name] - self._means[name]) @ self._whiten[name].T
                for name, model in self._surrogates.items()
            ],
            axis=1,
        )

    def reduced_chi_square(self, x: np.ndarray) -> float:
        """Return the sum of squares over the degrees of freedom."""
        residual = self.residuals(x[None])[0]
        return float(residual @ residual / (len(residual) - len(x)))

    def polish(self, x: np.ndarray) -> np.ndarray:
        """Return the least-squares point near `x`, within the bounds."""
        return self._minimise(x, np.ones(len(x), dtype=bool))[0]

    def intervals(self, x: np.ndarray) -> list[tuple[float, float]]:
        """Return the 95 % profile interval of each parameter, within the range searched."""
        least = self._minimise(x, np.ones(len(x), dtype=bool))[1]
        allowed = chi2.ppf(0.95, 1) * max(1.0, self.reduced_chi_square(x))
        found = []
        for k in range(len(x)):
            ends = []
            for bound in (self._lower[k], self._upper[k]):

                def excess(value: float, k: int = k) -> float:
                    start = x.copy()
                    start[k] = value
                    return self._minimise(start, np.arange(len(x)) != k)[1] - least - allowed

                if abs(bound - x[k]) < 1e-9 * (self._upper[k] - self._lower[k]) or excess(bound) <= 0:
                    ends.append(float(bound))
                else:
                    tolerance = 1e-3 * (self._upper[k] - self._lower[k])
                    ends.append(float(brentq(excess, x[k], bound, xtol=tolerance)))
            found.append((ends[0], ends[1]))
        return found

    def _minimise(self, x: np.ndarray, moving: np.ndarray) -> tuple[np.ndarray, float]:
        """Minimise over the coordinates `moving`; return the point and its sum of squares."""
        span = self._upper - self._lower
        unit = np.clip((x - self._lower) / span, 0.0, 1.0)

        def batch(parts: np.ndarray) -> np.ndarray:
            whole = np.tile(unit, (len(parts), 1))
            whole[:, moving] = parts
            return self.residuals(self._lower + whole * span)

        def jacobian(part: np.ndarray) -> np.ndarray:
            moves = 1e-4 * np.eye(len(part))
            both = batch(np.concatenate([part + moves, part - moves]))
            return (both[: len(part)] - both[len(part) :]).T / 2e-4

        if not moving.any():
            residual = batch(np.empty((1, 0)))[0]
            return x, float(residual @ residual)
        start = np.clip(unit[moving], 1e-6, 1 - 1e-6)
        result = least_squares(lambda part: batch(part[None])[0], start, jacobian, bounds=(0.0, 1.0), xtol=1e-10)
        whole = unit.copy()
        whole[moving] = result.x
        return self._lower + whole * span, float(2 * result.cost)
