"""One explanation at its best parameters: its curves and derivatives there, and the evidence for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_triangular
from scipy.special import logsumexp

from palpate.base.orthonormal import orthonormal
from palpate.inference.amplitude import Amplitude, own_amplitudes
from palpate.inference.amplitude_constraint import AmplitudeConstraint, departures, widenings
from palpate.inference.covariance import Errors
from palpate.inference.least_squares import central_slopes, remainder
from palpate.inference.marginal import Marginal, Modes
from palpate.inference.problem import Explanation, Problem
from palpate.models.coordinates import Coordinates
from palpate.models.forward import Forward, under_each

PRIOR_VARIANCE = 1.0 / 12.0
DENSITY_ONE = 1.0 / (2.0 * np.pi)  # variance of the Gaussian that is as dense at its middle as the even prior
SAME_SIZE = 0.3  # of the logarithm of the discrepancy's size, within which weights hardly change the estimate


@dataclass(frozen=True, eq=False)
class Fit:
    """The best parameters of one explanation.

    Attributes
    ----------
    explanation
        Its mechanisms.
    model
        The forward model, whose points are coordinates of the explanation.
    z : ndarray, shape (k,)
        Coordinates, see `palpate.inference.problem`.
    errors
        Errors of the mean curves.
    curve : ndarray, shape (n_all,)
        The forward model's curves at z [nm].
    tangent : ndarray, shape (n_all, k)
        Their slopes [nm].
    constraints
        Amplitudes that exact laws give: data, too.
    converged
        Whether the search that led here converged.
    """

    problem: Problem
    explanation: Explanation
    model: Forward
    z: np.ndarray
    errors: Errors
    curve: np.ndarray
    tangent: np.ndarray
    constraints: tuple[AmplitudeConstraint, ...] = ()
    converged: bool = True

    @cached_property
    def own(self) -> tuple[Amplitude, ...]:
        """Amplitudes of which each recording has its own."""
        return own_amplitudes(self.model.amplitudes(self.z)) if self.explanation else ()

    @cached_property
    def coordinates(self) -> Coordinates:
        """Of its parameters."""
        return self.model.coordinates

    @cached_property
    def everywhere(self) -> dict[str, np.ndarray | str]:
        """Curves (n_points,) under every condition that was tested [nm], or why the forward model failed there."""
        others = [name for name in self.problem.observed if name not in self.problem.names]
        found, nm = under_each(self.model, others, self.z), self.problem.nm
        there = {name: curve if isinstance(curve, str) else nm[name] * curve for name, curve in found.items()}
        return {**self.problem.split(self.curve), **there}

    @cached_property
    def factor(self) -> np.ndarray:
        """Lower Cholesky factor of the covariance."""
        return cholesky(self.errors.covariance, lower=True)

    @cached_property
    def modes(self) -> Modes:
        """Of the discrepancy of the law beside the known errors."""
        return Modes(cholesky(self.errors.known, lower=True), self.errors.law)

    def whiten(self, values: np.ndarray) -> np.ndarray:
        """Return L^-1 values."""
        return solve_triangular(self.factor, values, lower=True)

    @cached_property
    def residual(self) -> np.ndarray:
        """Mean recorded less simulated depth (n_all,) [nm]."""
        return self.problem.mean - self.curve

    @cached_property
    def by_sites(self) -> np.ndarray:
        """Matrix (n_all, n_all) that maps a residual to the most likely effect of the sites.

        A site is a factor of the depth. Where no replicates give its scatter, the fit of a test cannot distinguish its
        site from its level; elsewhere the matrix is zero.
        """
        if self.problem.replicated:
            return np.zeros((len(self.residual), len(self.residual)))
        errors = self.with_remainder.errors
        parts = zip(errors.components, errors.counts, strict=True)
        sites = block_diag(*(errors.noise.variances["site"] / count * part["site"] for part, count in parts))
        return np.linalg.solve(errors.covariance, sites).T

    @cached_property
    def of_sites(self) -> np.ndarray:
        """The most likely effect of the sites (n_all,) [nm]."""
        return self.by_sites @ self.residual

    @property
    def left(self) -> np.ndarray:
        """Residual less the most likely effect of the sites (n_all,) [nm]."""
        return self.residual - self.of_sites

    @cached_property
    def tangent_space(self) -> np.ndarray:
        """Orthonormal basis (n_all, m) of the whitened slopes of the parameters; m of these are independent."""
        return orthonormal(self.whiten(self.tangent))

    def off_tangent(self, white: np.ndarray) -> np.ndarray:
        """Return the part of whitened values (n_all, ...) off the tangent space."""
        return white - self.tangent_space @ (self.tangent_space.T @ white)

    @cached_property
    def white(self) -> np.ndarray:
        """Whitened residual (n_all,)."""
        return self.whiten(self.residual)

    def from_constraints(self, z: np.ndarray) -> np.ndarray:
        """Return the departures (m + b,) [standard deviations] at z (k,) from the constraints and uniaxial tests."""
        from_laws = departures(self.constraints, self.model.amplitudes(z))
        return np.append(from_laws, self.problem.bulk_departures(self.explanation, z))

    @property
    def constraint_misfits(self) -> np.ndarray:
        """What each constraint (m,) adds to -2 log likelihood, see `palpate.inference.amplitude_constraint`."""
        own = departures(self.constraints, self.model.amplitudes(self.z))
        return own**2 + widenings(self.constraints, self.explanation)

    @cached_property
    def constraint_tangent(self) -> np.ndarray:
        """Slope (m + b, k) of the departures from the constraints and from uniaxial tests."""
        return central_slopes(self.from_constraints, self.z)

    @cached_property
    def misfit(self) -> float:
        """Chi-square of curves and uniaxial tests, what constraints add, and that of the prior."""
        off, bulk = self.coordinates.departures(self.z), self.problem.bulk_departures(self.explanation, self.z)
        return float(self.white @ self.white + self.constraint_misfits.sum() + bulk @ bulk + off @ off)

    @property
    def misfit_ratio(self) -> float:
        """Chi-square of the mean curves per degree of freedom."""
        return float(self.white @ self.white) / max(len(self.white) - len(self.z), 1)

    @cached_property
    def log_likelihood(self) -> float:
        """Log-likelihood of the means, of the constraints and, where there are replicates, of their differences.

        The size of the law's discrepancy is the likeliest one, and counts with its prior.
        """
        noise, law = self.errors.noise, self.errors.law
        prior = law.log_prior if law and law.share else 0.0
        return (noise.log_likelihood if noise.replicated else 0.0) - 0.5 * self.misfit - self.log_volume + prior

    @cached_property
    def posterior(self) -> np.ndarray:
        """Covariance of the coordinates (k, k) to first order; an even prior has a variance of 1/12.

        Where the fit leaves more than the errors, the information of the curves is divided by the misfit ratio
        (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
        """
        white, constrained = self.whiten(self.tangent), self.constraint_tangent
        information = white.T @ white / max(self.misfit_ratio, 1.0) + constrained.T @ constrained
        return np.linalg.inv(information + self.coordinates.precision(PRIOR_VARIANCE))

    def joined(
        self, effects: np.ndarray, prior: np.ndarray | float, own: float = PRIOR_VARIANCE
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the change (k + m,) of all coordinates to first order if effects join, and its covariance.

        One unit of each adds a column (n_all, m) to the depth [nm]. Their coefficients have `prior` variances (m,), the
        fit's coordinates that of `own`; constraints do not count.
        """
        white = self.whiten(np.column_stack([self.tangent, effects]))
        variances = np.append(np.full(len(self.z), own), prior)
        covariance = np.linalg.inv(white.T @ white + np.diag(1.0 / variances))
        return covariance @ white.T @ self.white, covariance

    def marginal(self, columns: np.ndarray, further: Coordinates | None = None) -> Marginal:
        """Return the products of columns (n_all, c) for every size of the law's discrepancy.

        The columns are a residual, then slopes by the coordinates (k), whose prior and constraints count as data, then
        whatever else joins the curves. The prior of the coordinates is that of `further` ones, the last of which is at
        zero, if they are given.
        """
        found = Marginal.of(self.modes, columns)
        coordinates, z = (further, np.append(self.z, 0.0)) if further else (self.coordinates, self.z)
        off, slopes = coordinates.departures(z), coordinates.slopes_of_departures(z)
        off[coordinates.cauchy], slopes[coordinates.cauchy] = 0.0, 0.0
        slopes = np.vstack([slopes, np.pad(self.constraint_tangent, ((0, 0), (0, len(z) - len(self.z))))])
        rest = np.zeros((len(slopes), columns.shape[1] - 1 - len(z)))
        return found.with_data(np.column_stack([-np.append(off, self.from_constraints(self.z)), slopes, rest]))

    @cached_property
    def _sizes(self) -> tuple[Marginal, np.ndarray]:
        """The nodes of the discrepancy's size, and the logarithm of evidence times prior at each (q,).

        Coordinates with an even prior are integrated over about the best point, those with Cauchy's about its middle,
        from where the curves are linear; where the search did not converge, that prior counts at the point reached.
        """
        marginal = self.marginal(np.column_stack([self.residual, self.tangent]))
        cauchy, variance, found = self.coordinates.cauchy, self.coordinates.even_variances(DENSITY_ONE), []
        if not self.converged:
            prior = float(self.coordinates.log_cauchy(self.z))
            return marginal, marginal.log_prior + marginal.log_densities(variance, False) + prior
        about = marginal.from_elsewhere(cauchy + 1, 0.5 - self.z[cauchy])
        for weight, variance[cauchy] in self.coordinates.cauchy_mixture():
            found.append(weight + about.log_densities(variance))
        return marginal, marginal.log_prior + logsumexp(found, axis=0)

    def sized(self) -> Fit:
        """Return the same with the likeliest size of the law's discrepancy, the parameters integrated over."""
        if self.errors.law is None:
            return self
        marginal, density = self._sizes
        law = self.errors.law.sized(marginal.sizes[int(np.argmax(density))])
        return replace(self, errors=replace(self.errors, law=law))

    def alike(self, other: Fit) -> bool:
        """Return whether another fit's discrepancy of the law has about the same size."""
        own, others = self.errors.law, other.errors.law
        if own is None or others is None or not others.share:
            return own is others
        same = (own.size.own, own.size.kind) == (others.size.own, others.size.kind)
        return same and abs(np.log(own.share / others.share)) < SAME_SIZE

    def within(self, tolerance: float) -> float:
        """Return the probability that the best parameters leave no more than a share of the depth, see `law_share`."""
        if self.errors.law is None:
            return 1.0
        density, left = self._sizes[1], self.errors.law.left_by_best(self.tangent)
        return float(np.exp(density - logsumexp(density)) @ (left <= tolerance))

    def law_share(self, quantiles: Sequence[float] | np.ndarray, of_law: bool = False) -> np.ndarray:
        """Return quantiles of what the best parameters leave without noise, a root mean square in shares of the depth.

        Each size of the law's discrepancy counts with its probability; it is zero where the law is taken to be exact.
        With `of_law` only the part counts that obeys the scaling law.
        """
        if self.errors.law is None:
            return np.zeros(len(quantiles))
        density, left = self._sizes[1], self.errors.law.left_by_best(self.tangent, of_law)
        order = np.argsort(left)
        weights = np.exp(density - density.max())[order]
        middle = np.cumsum(weights) - 0.5 * weights
        return np.exp(np.interp(quantiles, middle / weights.sum(), np.log(left[order])))

    @cached_property
    def log_evidence(self) -> float:
        """Laplace's approximation, integrated over the size of the law's discrepancy.

        The prior of the amplitudes is normalised within their limits; that of the material has a density of one over
        the ranges, the same for all explanations.
        """
        noise = self.errors.noise
        known = noise.log_likelihood if noise.replicated else 0.0
        known -= 0.5 * float(widenings(self.constraints, self.explanation).sum())
        return known + float(logsumexp(self._sizes[1])) - self.coordinates.log_mass(self.problem.material)

    @property
    def optimistic_log_evidence(self) -> float:
        """Log evidence at the optimum to first order, where the fit was taken at other values of the parameters."""
        return replace(self, converged=True).log_evidence

    @cached_property
    def with_remainder(self) -> Fit:
        """The same fit, weighted by the known errors and a remainder that makes chi-square its degrees of freedom.

        Its parameters were found with these weights. Explanations that all fail are compared with them, too: by the
        known errors alone, the one that follows the smallest details best would count as the closest.
        """
        more = remainder(self.residual, *np.linalg.eigh(self.errors.covariance), len(self.z))
        return replace(self, errors=replace(self.errors, remainder=more))

    @property
    def log_volume(self) -> float:
        """Half the logarithm of the determinant of the covariance."""
        return float(np.log(np.diag(self.factor)).sum())
