"""The covariance of the mean curves: noise of the recordings and error of the solver, in one matrix.

A mesh whose rings grow by a constant ratio makes the same relative error at every depth: all curves of a tip are off by
one common factor, of standard deviation `solver_error`. The default of 0.003 covers what ``accuracy: standard`` differs
from the depth extrapolated in the mesh ratio: up to 0.2 % of the depth in elastic and creeping bodies; up to 0.5 %
where yielding prevails, which a study may state. Late in unloading the error has another shape: that of what the last
refinement of the mesh changed. Apart from the common factor, the next two refinements, to rings that grow by
1.033 and by 1.025, change 0.31 to 0.32 times as much in creeping bodies with and without friction (correlation 0.95 to
0.99), and 0.28 times where a body yields (0.6): `REFINED` times the change, common to all conditions, and half of that
in each alone.

A curve is rough, too: those of another finite-element code differ within a test by 0.02 to 0.056 % of the depth, in
details far shorter than a segment. `RIPPLE` of the mesh's error is that part, 0.03 % of the depth by default. Without
it the discrepancy of the law, which is smooth, follows such details with an amplitude far above what the law lacks.

What the law itself leaves has a covariance of its own, see `palpate.inference.discrepancy`.

An effect that every instrument has to some extent, such as drift, counts as noise up to the `background` that its
mechanism declares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.linalg import block_diag

from palpate.configuration.condition import Condition
from palpate.data.contrasts import Replicates, contrasts, without_trend
from palpate.data.noise import NoiseModel
from palpate.data.noise_fit import fit_noise
from palpate.inference.amplitude import Amplitude
from palpate.inference.discrepancy import Discrepancy, largest_depths
from palpate.inference.law_structure import ripple, same_tip
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.models.forward import Forward
from palpate.study.prescribed_segments import segments

ASSUMED_RANDOM_WALK = 0.02  # nm/s^0.5, standard deviation of the walk after a second without replicates
BACKGROUNDS = {key: mechanism.background for key, mechanism in MECHANISMS.items() if mechanism.background}
RIPPLE = 0.1  # of the mesh's error, which changes from point to point
REFINED = 0.3  # of what the last refinement changed, standard deviation of what the next ones will
LARGEST = {f"{key}.background": deviation**2 for key, deviation in BACKGROUNDS.items()}


@dataclass(frozen=True, eq=False)
class Errors:
    """The errors of the mean curves under one explanation.

    Attributes
    ----------
    noise
        Noise of single recordings; contains a component for each amplitude that varies, ``key.name``.
    components
        The components' matrices for each condition.
    model : ndarray, shape (n_all, n_all)
        Covariance of the errors of the simulation that the conditions of a tip have in common [nm^2].
    refinements
        For each condition what the last refinement of the simulation changed (n_points,) [nm].
    counts
        Number of recordings of each condition.
    between
        Variance of an amplitude ``key.name`` between conditions, beyond that between recordings.
    law
        The discrepancy of the law; None where the law is taken to be exact.
    remainder
        Variance of what is left beside all that, the same at all points [nm^2], see `palpate.inference.least_squares`.
    """

    noise: NoiseModel
    components: list[dict[str, np.ndarray]]
    model: np.ndarray
    refinements: Sequence[np.ndarray]
    counts: list[int]
    between: Mapping[str, float] = field(default_factory=dict)
    law: Discrepancy | None = None
    remainder: float = 0.0

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the mean curves (n_all, n_all) [nm^2]."""
        return self.known if self.law is None else self.known + self.law.covariance

    @property
    def known(self) -> np.ndarray:
        """The same without the discrepancy of the law."""
        known = self.of_mesh + self._between + block_diag(*self.blocks)
        return known + self.remainder * np.eye(len(known))

    @property
    def shared(self) -> np.ndarray:
        """Covariance of what all recordings of a condition have in common (n_all, n_all) [nm^2]."""
        return self.of_simulation + self._between

    @property
    def of_simulation(self) -> np.ndarray:
        """Covariance of the errors of the simulated curves (n_all, n_all) [nm^2], of the mesh and of the law."""
        return self.of_mesh if self.law is None else self.of_mesh + self.law.covariance

    @property
    def of_mesh(self) -> np.ndarray:
        """Covariance of the errors of the mesh (n_all, n_all) [nm^2]."""
        return self.model + refinement_covariance(self.refinements)

    @property
    def _between(self) -> np.ndarray:
        values = (v * block_diag(*(parts[key] for parts in self.components)) for key, v in self.between.items())
        return sum(values, np.zeros_like(self.model))

    def slopes(self, weights: np.ndarray) -> np.ndarray:
        """Return the derivative of ``covariance @ weights`` by each estimate of the noise (n_all, p)."""
        rows = np.split(weights, np.cumsum([len(next(iter(parts.values()))) for parts in self.components])[:-1])
        found = []
        for k, (parts, n, row) in enumerate(zip(self.components, self.counts, rows, strict=True)):
            of_condition = np.zeros((len(row), len(self.noise.covariance)))
            for place, slope in self.noise.slopes(k, parts).items():
                of_condition[:, place] = slope @ row / n
            found.append(of_condition)
        return np.vstack(found)

    @property
    def blocks(self) -> list[np.ndarray]:
        """Covariance (n, n) of the noise of the mean of each condition's recordings [nm^2]."""
        counted = enumerate(zip(self.components, self.counts, strict=True))
        return [self.noise.matrix(k, parts) / n for k, (parts, n) in counted]


def model_covariance(
    curves: Mapping[str, np.ndarray], relative_error: float, shares: Mapping[str, float]
) -> np.ndarray:
    """Return the covariance (n_all, n_all) of one factor that all curves (n_points,) share [nm^2].

    Each response departs by its `shares` of that, see `palpate.observables.observable.Quantity`; by one if not given.
    """
    depth = relative_error * np.concatenate([shares.get(name, 1.0) * curve for name, curve in curves.items()])
    return np.outer(depth, depth)


def refinement_covariance(changes: Sequence[np.ndarray]) -> np.ndarray:
    """Return the covariance (n_all, n_all) of what further refinements change, of the last `changes` (n_points,)."""
    together = np.concatenate(changes)
    alone = block_diag(*(np.outer(change, change) for change in changes))
    return REFINED**2 * (np.outer(together, together) + alone / 4.0)


def components(problem: Problem, own: Sequence[Amplitude], depth: np.ndarray) -> list[dict[str, np.ndarray]]:
    """Return the matrices of the variance components of each condition, of curves `depth` (n_all,) [nm]."""
    curves = problem.split(depth)
    return [components_under(problem, own, condition, curves[condition.name]) for condition in problem.conditions]


def components_under(
    problem: Problem, own: Sequence[Amplitude], condition: Condition, curve: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the matrices (n, n) of the variance components of a condition, of its `curve` (n,) [nm].

    Where an amplitude that differs between recordings (`own`) has the same effect as a background, the background is
    left out: the variances of two equal components could not be separated.

    Parameters
    ----------
    problem
        The data of the diagnosis.
    own
        Amplitudes that differ between recordings.
    condition
        The condition.
    curve : ndarray, shape (n,)
        Its depth [nm].
    """
    time = condition.protocol.sample_time
    site = problem.shares.get(condition.name, 1.0) * curve
    parts = condition.observable.noise(time, site)
    none = np.zeros_like(time)
    unloaded = [amplitude.added(time, none) for amplitude in own]
    for key in BACKGROUNDS:
        (background,) = problem.typical(key)
        column = background.added(time, none)
        if not any(np.array_equal(column, other) for other in unloaded):
            parts[f"{key}.background"] = np.outer(column, column)
    columns = [(a, a.covariances(problem.unit_effect(a, condition), condition.protocol)) for a in own]
    return parts | {name: matrix for a, found in columns for name, matrix in zip(a.components, found, strict=True)}


def assumed_variances(problem: Problem, own: Sequence[Amplitude], site_scatter: float) -> dict[str, float]:
    """Return the variances that count where at most half are repeated; of a plausible range, a tenth."""
    assumed = {"site": site_scatter**2, "random_walk": ASSUMED_RANDOM_WALK**2}
    assumed |= {name: 0.3**2 * largest for name, largest in LARGEST.items()}
    return assumed | {name: (0.1 * problem.largest(a)) ** 2 for a in own for name in a.components}


def noise_of(problem: Problem, own: tuple[Amplitude, ...], residual: np.ndarray, site_scatter: float) -> NoiseModel:
    """Fit the noise where recordings have some amplitudes of their `own`.

    Where at most half of the conditions are repeated a `residual` (n_all,) [nm] serves.

    Parameters
    ----------
    problem, own
        See `components_under`.
    residual : ndarray, shape (n_all,)
        Of a fit [nm].
    site_scatter
        Assumed scatter of the depth between sites [-], where at most half of the conditions are repeated.
    """
    if problem.replicated:
        found = noise_between_replicates(problem, own, site_scatter)
        return found.spread(problem.repeated, len(problem.conditions))
    assumed, models = assumed_variances(problem, own, site_scatter), []
    for condition, part in zip(problem.conditions, components(problem, own, problem.mean), strict=True):
        item = problem.observed[condition.name]
        basis = without_trend(list(segments(condition.protocol).values()))
        rest = np.sqrt(len(item.response)) * problem.split(residual)[condition.name]
        replicates = Replicates((basis @ rest)[None], basis, part, float(np.abs(item.mean).max()))
        models.append(fit_noise([replicates], assumed, False, LARGEST))
    return NoiseModel.joined(models)


@lru_cache(maxsize=64)
def noise_between_replicates(problem: Problem, own: tuple[Amplitude, ...], site_scatter: float) -> NoiseModel:
    """Fit the noise of the repeated conditions to what distinguishes replicates, whatever else an explanation holds."""
    replicates, parts = [], components(problem, own, problem.mean)
    for k in problem.repeated:
        item = problem.observed[problem.conditions[k].name]
        identity = np.eye(len(item.time))
        replicates.append(Replicates(contrasts(item.response), identity, parts[k], float(np.abs(item.mean).max())))
    narrower = [tuple(other for other in own if other.key != key) for key in dict.fromkeys(each.key for each in own)]
    within = [noise_between_replicates(problem, rest, site_scatter) for rest in narrower]
    return fit_noise(replicates, assumed_variances(problem, own, site_scatter), True, LARGEST, within)


def errors(
    problem: Problem,
    model: Forward,
    own: Sequence[Amplitude],
    depth: np.ndarray,
    noise: NoiseModel,
    solver_error: float,
    effects: Mapping[str, np.ndarray] | None = None,
    law_error: float = 0.0,
) -> Errors:
    """Return the errors of the mean curves about simulated curves `depth` (n_all,) [nm].

    Errors in proportion to the depth are taken in proportion to the simulated curves: with recorded ones, whose noise
    would count as depth, the fit would be biased to smaller depths (G. D'Agostini, Nucl. Instrum. Methods A 346 (1994)
    306-311). Each effect has a common relative error, its mechanism's `solver_scatter`.

    Parameters
    ----------
    problem
        The data of the diagnosis.
    model
        The forward model that gave the curves.
    depth : ndarray, shape (n_all,)
        Simulated curves [nm].
    noise
        Noise of single recordings.
    solver_error
        Relative error of the simulated depth, standard deviation [-].
    own
        Amplitudes of which each recording has its own.
    effects
        What mechanisms add to the curves (n_all,) [nm], where it is known.
    law_error
        Median of the prior of the law's discrepancy, whose size is zero yet; 0 where the law is taken to be exact.
    """
    common = same_tip(problem.indentations) * model_covariance(problem.split(depth), solver_error, problem.shares)
    common = common + rough_covariance(problem, depth, solver_error)
    for key, effect in (effects or {}).items():
        common = common + np.outer(effect, effect) * MECHANISMS[key].solver_scatter ** 2
    counts = [len(problem.observed[c.name].response) for c in problem.conditions]
    law = discrepancy_of(problem, depth, law_error) if law_error else None
    parts = components(problem, own, depth)
    return Errors(noise, parts, common, of_mesh(problem, model, solver_error), counts, law=law)


def rough_covariance(problem: Problem, depth: np.ndarray, solver_error: float) -> np.ndarray:
    """Return the covariance (n_all, n_all) of the ripple of curves `depth` (n_all,) on a mesh [nm^2]."""
    deviation = RIPPLE * solver_error * largest_depths(problem.split(depth), problem.shares)
    correlation = ripple(problem.indentations)
    return correlation * np.outer(deviation, deviation)


def discrepancy_of(problem: Problem, depth: np.ndarray, law_error: float) -> Discrepancy:
    """Return the law's discrepancy about curves `depth` (n_all,) [nm], of size zero yet."""
    return Discrepancy.of(problem.indentations, problem.split(depth), law_error, problem.shares)


def of_mesh(problem: Problem, model: Forward, solver_error: float) -> list[np.ndarray]:
    """Return what the last refinement of a model changed in each condition (n_points,) [nm].

    It is nothing where no error of the solver is allowed for.
    """
    return [np.sign(solver_error) * change for change in problem.refinements(model)]
