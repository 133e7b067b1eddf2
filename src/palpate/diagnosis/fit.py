"""Fitting one explanation: material and mechanisms together, with the evidence for it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.stats import qmc

from palpate.diagnosis.correction import Correction
from palpate.diagnosis.covariance import Errors, varying
from palpate.diagnosis.design import mechanism_dimensions
from palpate.diagnosis.law import Law, departures
from palpate.diagnosis.local import Local
from palpate.diagnosis.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS

PRIOR_VARIANCE = 1.0 / 12.0
DENSITY_ONE = 1.0 / (2.0 * np.pi)  # variance of the Gaussian that is as dense at its middle as the even prior
STEP = 1e-4
OWN_VALUES = (0.0, 0.01, 0.03, 0.1, 0.3)
TRIALS = 32
PAST_KINKS = (-0.05, -0.01, 0.01, 0.05)  # of the range of a delay: from where beside an optimum a search begins again


@dataclass(frozen=True, eq=False)
class Fit:
    """The best parameters of one explanation.

    Attributes
    ----------
    explanation
        Its mechanisms.
    z : ndarray, shape (k,)
        Coordinates, see `palpate.diagnosis.problem`.
    errors
        Errors of the mean curves.
    correction
        What the forward model adds to the surrogates' curves near z.
    laws
        What exact laws say about amplitudes: data, too.
    local
        The forward model's curves around z, once known: they take the place of surrogates and correction.
    """

    problem: Problem
    explanation: Explanation
    z: np.ndarray
    errors: Errors
    correction: Correction
    laws: tuple[Law, ...] = ()
    local: Local | None = None

    @cached_property
    def factor(self) -> np.ndarray:
        """Lower Cholesky factor of the covariance."""
        return cholesky(self.errors.covariance, lower=True)

    def whiten(self, values: np.ndarray) -> np.ndarray:
        """Return L^-1 values."""
        return solve_triangular(self.factor, values, lower=True)

    def curves(self, z: np.ndarray) -> np.ndarray:
        """Return the curves (m, n_all) at coordinates z (m, k) [nm]."""
        return self.local(z) if self.local else self.problem.curves(self.explanation, z) + self.correction(z)

    @cached_property
    def curve(self) -> np.ndarray:
        """Curves at z [nm]."""
        return self.curves(self.z[None])[0]

    @cached_property
    def residual(self) -> np.ndarray:
        """Mean recorded less simulated depth (n_all,) [nm]."""
        return self.problem.mean - self.curve

    @cached_property
    def tangent(self) -> np.ndarray:
        """Slope of the curves (n_all, k) [nm]."""
        if self.local:
            return self.local.slope_at(self.z)
        return self.problem.jacobian(self.explanation, self.z) + self.correction.slope

    @cached_property
    def tangent_space(self) -> np.ndarray:
        """Orthonormal basis (n_all, k) of the whitened slopes of the parameters."""
        return np.linalg.qr(self.whiten(self.tangent))[0]

    @cached_property
    def white(self) -> np.ndarray:
        """Whitened residual (n_all,)."""
        return self.whiten(self.residual)

    def from_laws(self, z: np.ndarray) -> np.ndarray:
        """Return by how many standard deviations the amplitudes at z (k,) depart from the laws."""
        return departures(self.laws, self.problem.amplitudes(self.explanation, z))

    @cached_property
    def law_tangent(self) -> np.ndarray:
        """Slope (n_laws, k) of the departures from the laws."""
        slope = np.zeros((len(self.laws), len(self.z)))
        if self.laws:
            for k in range(self.problem.space.dimensions, len(self.z)):
                step = np.where(np.arange(len(self.z)) == k, STEP, 0.0)
                slope[:, k] = (self.from_laws(self.z + step) - self.from_laws(self.z - step)) / (2 * STEP)
        return slope

    @property
    def misfit(self) -> float:
        """Chi-square of the mean curves and of the laws."""
        off = self.from_laws(self.z)
        return float(self.white @ self.white + off @ off)

    @cached_property
    def log_likelihood(self) -> float:
        """Of means, laws and, where there are replicates, what distinguishes them."""
        noise = self.errors.noise
        return (noise.log_likelihood if noise.replicated else 0.0) - 0.5 * self.misfit - self.log_volume

    @cached_property
    def posterior(self) -> np.ndarray:
        """Covariance of the coordinates (k, k) to first order; each has a variance of 1/12 beforehand."""
        return np.linalg.inv(self.information + np.eye(len(self.z)) / PRIOR_VARIANCE)

    @cached_property
    def information(self) -> np.ndarray:
        """What curves and laws tell about the coordinates (k, k), to first order."""
        white = self.whiten(self.tangent)
        return white.T @ white + self.law_tangent.T @ self.law_tangent

    @cached_property
    def log_evidence(self) -> float:
        """Laplace's approximation with priors that are even over the ranges, each of density one."""
        sharpened = np.eye(len(self.z)) + DENSITY_ONE * self.information
        return self.log_likelihood - 0.5 * float(np.linalg.slogdet(sharpened)[1])

    @cached_property
    def promise(self) -> float:
        """Logarithm of the evidence, were the surrogates exact and the misfit no greater: what may be found without.

        Errors of surrogates cost evidence by widening the covariance, whether they err here or not. Beside others, what
        is hard to learn would never reach the forward model.
        """
        exact = replace(self, errors=self.errors.exact)
        return self.log_evidence + self.log_volume - exact.log_volume

    @property
    def log_volume(self) -> float:
        """Half the logarithm of the determinant of the covariance."""
        return float(np.log(np.diag(self.factor)).sum())


def solve(
    problem: Problem,
    explanation: Explanation,
    errors: Errors,
    starts: Iterable[np.ndarray],
    correction: Correction | None = None,
    radius: float = 1.0,
    laws: Sequence[Law] = (),
) -> Fit:
    """Find the best coordinates within `radius` of any of the given starts by bounded least squares."""
    correction = correction or Correction.none(len(problem.mean), problem.dimensions(explanation))
    found = [minimised(Fit(problem, explanation, z, errors, correction, tuple(laws)), radius) for z in starts]
    best = min(found, key=lambda fit: fit.misfit)
    again = [minimised(replace(best, z=z), radius) for z in _past_kinks(best, radius)]
    return spread_own_values(min([best, *again], key=lambda fit: fit.misfit), radius)


def _past_kinks(fit: Fit, radius: float) -> list[np.ndarray]:
    """Return coordinates to either side of a fit's, within `radius`, where an effect delays the curve.

    As the delay passes a sample, the depth there stops falling as steeply as a root begins: a kink, in which a search
    stays that comes from one side.
    """
    own = fit.problem.parts(fit.explanation, np.arange(len(fit.z)))[1]
    delays = [k for key, numbers in own.items() if MECHANISMS[key].shortcut for k in numbers]
    steps = [off * np.eye(len(fit.z))[k] for k in delays for off in PAST_KINKS if abs(off) <= radius]
    return [np.clip(fit.z + step, 0.0, 1.0) for step in steps]


def minimised(fit: Fit, radius: float) -> Fit:
    """Return the fit at the least misfit reached from its coordinates, within `radius` of each."""

    def at(z: np.ndarray) -> Fit:
        moved = replace(fit, z=z)
        moved.__dict__["factor"] = fit.factor
        return moved

    start = np.clip(fit.z, 1e-4, 1 - 1e-4)
    found = least_squares(
        lambda z: np.concatenate([-at(z).white, fit.from_laws(z)]),
        start,
        lambda z: np.vstack([fit.whiten(at(z).tangent), at(z).law_tangent]),
        bounds=(np.maximum(start - radius, 0.0), np.minimum(start + radius, 1.0)),
        max_nfev=40,
        xtol=1e-5,
        ftol=1e-6,
    )
    return at(found.x)


def spread_own_values(fit: Fit, radius: float) -> Fit:
    """Let the value of a mechanism that varies differ between conditions, by as much as is likeliest."""
    given = fit.errors.between
    for key in varying(fit.explanation):
        best, chosen = -np.inf, fit
        for share in OWN_VALUES:
            between = {**fit.errors.between, key: (share * fit.problem.largest(key)) ** 2}
            trial = replace(fit, errors=replace(fit.errors, between=between))
            tangent = trial.whiten(fit.tangent)
            left = trial.white - tangent @ np.linalg.lstsq(tangent, trial.white, rcond=1e-10)[0]
            likelihood = -0.5 * float(left @ left) - trial.log_volume
            if likelihood > best + 2.0 * (share > 0 and best > -np.inf):
                best, chosen = likelihood, trial
        fit = chosen
    changed = any(variance != given.get(key, 0.0) for key, variance in fit.errors.between.items())
    return minimised(fit, radius) if changed else fit


def starting_points(base: Fit, key: str, count: int = 2) -> list[np.ndarray]:
    """Return where the search for one more mechanism begins: the amplitudes of least misfit to first order.

    The effect is taken at the base fit's material, and its material parameters follow linearly.
    """
    problem = base.problem
    dimensions = mechanism_dimensions(MECHANISMS[key], problem.scale)
    trials = np.linspace(0.0, 1.0, 9)[:, None] if dimensions == 1 else qmc.Sobol(dimensions, seed=0).random(TRIALS)
    u = problem.parts(base.explanation, base.z)[0]
    tangent = base.whiten(base.tangent)
    left = base.whiten(base.residual[:, None] - problem.effect(key, u, trials).T)
    change = np.linalg.lstsq(tangent, left, rcond=1e-8)[0]
    misfit = np.sum((left - tangent @ change) ** 2, axis=0)
    order = np.argsort(misfit)[:count]
    return [np.concatenate([np.clip(base.z + 0.5 * change[:, i], 0.02, 0.98), trials[i]]) for i in order]
