"""The effect of each mechanism on the curves, simulated at a few amplitudes at the base model's optimum.

The derivative of the curves at zero amplitude is of little use for a yield stress, a film or a further Voigt element,
whose effects vanish there with all their derivatives, or leave a parameter undetermined. So each mechanism that changes
the simulation is simulated at some amplitudes; one that only adds to the depth costs nothing. To first order in the
material's parameters, these effects give the largest decrease of the misfit by each mechanism, the start of its search,
and the directions in which the residual is tested.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import qmc

from palpate.diagnosis.coefficient_prior import NEUTRAL, neutral_place, with_coefficient
from palpate.errors import PalpateError
from palpate.inference.amplitude import Amplitude
from palpate.inference.explanation import DENSITY_ONE, PRIOR_VARIANCE, Fit
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.models.coordinates import CAUCHY, CAUCHY_WEIGHTS, Coordinates
from palpate.solver.variation import added_by_instrument

SHOWN = 0.75  # of the ranges, where an effect that may join is taken
SIMULATED = (0.05, 0.25, SHOWN, 1.0)  # of the range of a single amplitude
ADDED = np.linspace(0.0, 1.0, 9)
SCATTERED = 8  # places for several quantities
ADDED_SCATTERED = 32
EVEN_DEVIATION = 1.0 / np.sqrt(12.0)  # of an even prior, in widths of the range
FURTHEST = 1.5  # times an effect, to which it may grow in proportion
STARTS = 3  # amplitudes of least misfit, at which a search may begin


@dataclass(frozen=True, eq=False)
class Screen:
    """Effects of mechanisms on all curves, at the base model's optimum.

    Parameters
    ----------
    trials
        Coordinates (m, d) of each mechanism's amplitudes; at the first one that has several, all lie at `SHOWN`.
    effects
        What it adds to the curves there (m, n_all) [nm].
    failed
        Why the forward model failed, for mechanisms with which it failed at all amplitudes.
    """

    trials: Mapping[str, np.ndarray]
    effects: Mapping[str, np.ndarray]
    failed: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, fit: Fit, keys: Sequence[str], threads: int = 1) -> Screen:
        """Return the effects of mechanisms at the optimum of the base model, simulated on some threads."""
        trials, effects, failed = {}, {}, {}
        with ThreadPoolExecutor(threads) as pool:
            begun = {
                key: pool.submit(_simulated if fit.problem.is_simulated(key) else _added, fit, key) for key in keys
            }
        for key, found in begun.items():
            try:
                trials[key], effects[key] = found.result()
            except PalpateError as error:
                failed[key] = str(error)
        return cls(trials, effects, failed)

    @property
    def keys(self) -> list[str]:
        """The mechanisms whose effects are known."""
        return list(self.trials)

    def shown(self, key: str) -> np.ndarray:
        """Return the effect (n_all,) [nm] at three quarters of the ranges, or where that is nearest."""
        return self.effects[key][self._shown(key)]

    def place_shown(self, key: str) -> np.ndarray:
        """Return the coordinates (d,) of the mechanism's amplitudes there."""
        return self.trials[key][self._shown(key)]

    def log_evidence(self, fit: Fit, key: str) -> float:
        """Return the log evidence once a mechanism joins a fit, to first order.

        Each simulated effect is taken in proportion to a positive coefficient, with the mean square that an even prior
        over the range gives it, or Cauchy's prior; the material and the size of the law's discrepancy are integrated
        over. The evidence is the mean over the amplitudes tried. With a prior from an earlier study, it is that of the
        coefficient of one of them.
        An amplitude that differs between recordings has another one in each condition, too.
        """
        columns = [fit.residual[:, None], fit.tangent, self.effects[key].T]
        own = np.empty((len(fit.residual), 0))
        if MECHANISMS[key].varies:
            sizes = [fit.problem.typical_size(amplitude) for amplitude in fit.problem.typical(key)]
            own = fit.problem.effects_by_test(key) * np.tile(sizes, len(fit.problem.conditions))
        marginal, k = fit.marginal(np.column_stack([*columns, own])), len(fit.z)
        first, count = 1 + k, len(self.effects[key])
        found, even = [], fit.coordinates.even_variances(DENSITY_ONE)
        at = marginal.of_columns(range(first))
        without = float(logsumexp(at.log_prior + at.log_densities(even, fit.converged)))
        if further := with_coefficient(fit, key, self.trials[key]):
            return fit.log_evidence + self._log_density_joined(fit, key, *further) - without
        for number, variances in enumerate(self.prior_variances(fit, key)):
            trial = marginal.of_columns([*range(first), first + number])
            for weight, variance in variances:
                shared = np.append(even, variance)
                found.append(weight + logsumexp(trial.log_prior + trial.log_densities(shared, positive=True)))
        if own.shape[1]:
            each = marginal.of_columns([*range(first), *range(first + count, first + count + own.shape[1])])
            spread = np.append(even, np.ones(own.shape[1]))
            found.append(logsumexp(each.log_prior + each.log_densities(spread)) + np.log(count))
        mass = fit.problem.coordinates((key,)).log_mass(fit.problem.material)
        return fit.log_evidence + float(logsumexp(found)) - np.log(count) - without - mass

    def _log_density_joined(self, fit: Fit, key: str, further: Coordinates, number: int) -> float:
        """Return the log density of a fit's residual once a trial of a mechanism joins, see `with_coefficient`.

        It is relative to the mass of the prior of the fit.
        """
        columns = np.column_stack([fit.residual, fit.tangent, self.effects[key][number]])
        joined, material = fit.marginal(columns, further), fit.problem.material
        mass = further.log_mass(material) - fit.coordinates.log_mass(material)
        densities = joined.log_densities(further.even_variances(DENSITY_ONE))
        return float(logsumexp(joined.log_prior + densities)) - mass

    def prior_variances(self, fit: Fit, key: str) -> list[list[tuple[float, float]]]:
        """Return the logarithms of weights and the variances that make the prior of the coefficient of each trial.

        Where the amplitude is even over the range, its mean square about the neutral value is a third of the square of
        the way to the farther end. Where there are several quantities, their even ranges are sampled by the trials.
        """
        places, coordinates = self.trials[key], fit.problem.coordinates((key,))
        added = coordinates.free[fit.problem.material :]
        parts = list(zip(np.log(CAUCHY_WEIGHTS), CAUCHY, strict=True))
        if len(added) > 1 and len(coordinates.cauchy):
            share = float(np.mean(coordinates.cauchy_sizes)) / EVEN_DEVIATION
            return [[(float(weight), (size * share) ** 2) for weight, size in parts]] * len(places)
        if len(added) > 1:
            return [[(0.0, 1.0)]] * len(places)
        (start,) = neutral_place(fit.problem, key).tolist()
        away = np.maximum(np.abs(places[:, 0] - start), NEUTRAL)
        if len(coordinates.cauchy):
            (typical,) = coordinates.cauchy_sizes
            return [[(float(weight), (size * typical / each) ** 2) for weight, size in parts] for each in away]
        return [[(0.0, (max(start, 1.0 - start) / each) ** 2 / 3.0)] for each in away]

    def with_effect(self, fit: Fit, key: str) -> Fit:
        """Return a fit with a mechanism's effect of largest gain added to its curves, to first order in all else."""
        shares, gains = self._shares(fit, key)
        effect = shares[gains.argmax()] * self.effects[key][gains.argmax()]
        left = fit.whiten(fit.residual - effect)
        change = np.linalg.lstsq(fit.whiten(fit.tangent), left, rcond=1e-8)[0]
        return replace(fit, curve=fit.curve + effect + fit.tangent @ change)

    def starts(self, fit: Fit, key: str) -> list[np.ndarray]:
        """Return where searches may begin for a fit and one more mechanism, that of least misfit first.

        At the amplitudes of least misfit, the material's parameters and the other amplitudes take half of their
        first-order step. Where the model is far from linear that step is wrong, so at others they stay; the last is the
        weakest effect, which leaves the fit about as it is. An effect in proportion to one quantity has the size that
        lowers the misfit most.
        """
        if not fit.problem.is_simulated(key) and self.trials[key].shape[1] > 1:
            return _linear_starts(fit, key, self.trials[key])
        places, effects = self.trials[key].copy(), self.effects[key].T
        for k, searched in enumerate(MECHANISMS[key].searched(fit.problem.scale).values()):
            if searched.proportional:
                shares, coordinates = self._shares(fit, key)[0], fit.problem.coordinates((key,)).free
                size = coordinates[fit.problem.material + k]
                places[:, k], effects = size.scaled(shares * size.physical(places[:, k])), shares * effects
        tangent = fit.whiten(fit.tangent)
        left = fit.whiten(fit.residual[:, None] - effects)
        change = np.linalg.lstsq(tangent, left, rcond=1e-8)[0]
        moved = np.argsort(np.sum((left - tangent @ change) ** 2, axis=0))[:STARTS]
        change = np.clip(0.5 * change, -0.5, 0.5)
        staying = np.argsort(np.sum(left**2, axis=0))[:STARTS]
        weakest = np.argmin(np.sum(fit.whiten(effects) ** 2, axis=0))
        steps = [(change[:, i], i) for i in moved] + [(np.zeros(len(fit.z)), i) for i in (*staying, weakest)]
        return [np.concatenate([fit.z + step, places[i]]) for step, i in steps]

    def _shown(self, key: str) -> int:
        return int(np.abs(self.trials[key] - SHOWN).max(axis=1).argmin())

    def _shares(self, fit: Fit, key: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the factor of each effect (m,) that lowers chi-square most, and the decrease."""
        left, effects = fit.off_tangent(fit.white), fit.off_tangent(fit.whiten(self.effects[key].T))
        size, along = np.sum(effects**2, axis=0), left @ effects
        shares = np.clip(np.divide(along, size, out=np.zeros_like(size), where=size > 0.0), 0.0, FURTHEST)
        return shares, shares * (2.0 * along - shares * size)


def _linear_starts(fit: Fit, key: str, places: np.ndarray) -> list[np.ndarray]:
    """Return the starts of a mechanism that only adds to the depth, those of least misfit first.

    At each of the coordinates `places` (m, d) the amplitudes are replaced by those of linear least squares with priors,
    together with all free parameters; the mechanism's other parameters stay. The last one adds nothing.
    """
    problem, material, found = fit.problem, fit.problem.material, list[tuple[float, np.ndarray]]()
    mechanism, explanation = MECHANISMS[key], (key,)
    where = [problem.place(explanation, f"{key}.{name}") for name in mechanism.amplitudes]
    for place in places:
        start = np.append(fit.z[:material], place)
        start[where] = [problem.coordinates(explanation).free[k].scaled(0.0) for k in where]
        amplitudes = Amplitude.of(key, problem.amplitudes(explanation, start)[key])
        columns = [problem.unit_effects(a) * problem.quantity(explanation, start, str(a))[1] for a in amplitudes]
        change, covariance = fit.joined(np.column_stack(columns), np.full(len(columns), PRIOR_VARIANCE))
        none = np.append(fit.z, start[material:])
        start[where] += change[len(fit.z) :]
        moved = fit.z + np.clip(change[: len(fit.z)], -0.5, 0.5)
        gain = float(change @ np.linalg.solve(covariance, change))
        found.append((-gain, np.append(moved, start[material:])))
    return [start for _, start in sorted(found, key=lambda each: each[0])[:STARTS]] + [none]


def screened_places(problem: Problem, key: str) -> np.ndarray:
    """Return the coordinates (m, d) at which a mechanism is screened; more where nothing must be simulated.

    The last ones are those that an earlier study expects.
    """
    return np.vstack([_scattered_places(problem, key), *_expected_places(problem, key)])


def _expected_places(problem: Problem, key: str) -> list[np.ndarray]:
    """Return the means (d,) of a mechanism's amplitudes in each set with it that an earlier study fitted."""
    earlier = problem.scale.instrument
    return [each.of([key]).mean for members, each in earlier.amplitudes.items() if key in members] if earlier else []


def _scattered_places(problem: Problem, key: str) -> np.ndarray:
    dimensions, is_simulated = len(problem.coordinates((key,)).free) - problem.material, problem.is_simulated(key)
    if dimensions == 1:
        return np.array(SIMULATED if is_simulated else ADDED)[:, None]
    points = qmc.Sobol(dimensions, seed=0)  # a fixed design, as `SIMULATED` is: no verdict hangs on a draw
    scattered = points.random(SCATTERED if is_simulated else ADDED_SCATTERED)
    return np.vstack([np.full(dimensions, SHOWN), scattered[1:]])


def _added(fit: Fit, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates (m, d) of a mechanism, and what it adds to the depths of all conditions (m, n_all) [nm]."""
    problem, effects = fit.problem, []
    curves = problem.split(fit.curve)
    places = screened_places(problem, key)
    for place in places:
        values = problem.amplitudes((key,), np.append(fit.z[: problem.material], place))
        added = [added_by_instrument(values, c.protocol, curves[c.name], c.order) for c in problem.conditions]
        effects.append(np.concatenate(added))
    return places, np.array(effects)


def _simulated(fit: Fit, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates (m, d) of a mechanism at which the forward model succeeds, and the effects (m, n_all) [nm].

    Raises
    ------
    PalpateError
        When it fails at all of them.
    """
    problem = fit.problem
    places = screened_places(problem, key)
    outcomes = problem.model((key,)).curves([np.append(fit.z, place) for place in places])
    good = [not isinstance(curves, str) for curves in outcomes]
    if not any(good):
        raise PalpateError(str(outcomes[0]))
    return places[good], np.array([problem.stacked(each) - fit.curve for each in outcomes if not isinstance(each, str)])
