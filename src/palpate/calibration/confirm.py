r"""Confirmation by the forward model, and the steps that free the estimate from the surrogate's error.

A surrogate that is right to half a per cent may still be wrong about the slope of a weak parameter, and one over wide
ranges is off by tens of nanometres. So the forward model f is run at the estimate u_0, and a cheaper one, c, such as a
coarser mesh, takes the surrogate's place, with what it misses there added:

    u_{i+1} = argmin chi^2 of c(u) + f(u_i) - c(u_i) within the bounds.

What c misses hardly depends on u. So a few runs of f settle the estimate, however long and bent its way was. The run of
least chi^2 counts: a confirmation never makes an estimate worse.

Source: zeroth-order additive correction of a model hierarchy, Eldred, Giunta & Collis, AIAA 2004-4457.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from palpate.calibration.polish import WeightedFit
from palpate.errors import PalpateError

Curves = Mapping[str, np.ndarray]
Confirm = Callable[[dict[str, float]], Curves]
ConfirmAll = Callable[[Sequence[dict[str, float]]], Sequence[Curves]]
STEP = 0.02
STILL = 0.3
SEARCH = 30
GAIN = 0.1
FINE = 3e-3


@dataclass(frozen=True, eq=False)
class Tangent:
    """Linear predictor: the curve and its slope at one point.

    Parameters
    ----------
    x : ndarray, shape (p,)
        Physical parameters.
    curve : ndarray, shape (n_points,)
        [nm]
    slope : ndarray, shape (n_points, p)
        [nm per unit of the parameter]
    """

    x: np.ndarray
    curve: np.ndarray
    slope: np.ndarray

    def predict(self, X: np.ndarray) -> np.ndarray:
        """Curves (n, n_points) [nm] at parameters X (n, p)."""
        return self.curve + (X - self.x) @ self.slope.T

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Slope (n_points, p), the same everywhere."""
        return self.slope


@dataclass(frozen=True, eq=False)
class Confirmation:
    """What the forward model said.

    Attributes
    ----------
    fit
        The least-squares problem with tangents of the forward model at `u` in place of surrogates.
    u : ndarray, shape (k,)
        Scaled coordinates of the run of least chi^2.
    curves
        Forward-model curve of every condition there [nm].
    settled
        Whether the last search met no failure and moved the curves by less than 0.3 standard deviations a parameter.
    runs
        For each run: `parameters`, `chi_square`, and `surrogate_error_nm`, the largest difference from the
        surrogate, by condition.
    """

    fit: WeightedFit
    u: np.ndarray
    curves: Curves
    settled: bool
    runs: list[dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Cheaper:
    """The cheaper forward model with its slopes, of which no point is asked twice.

    Parameters
    ----------
    fit
        The problem whose conditions are asked for.
    model
        From a list of parameters by name to one mapping of curves each.
    """

    fit: WeightedFit
    model: ConfirmAll
    _known: dict[bytes, tuple[Curves, Curves]] = field(default_factory=dict, repr=False)

    def __call__(self, u: np.ndarray) -> tuple[Curves, Curves]:
        """Curves (n_points,) and slopes (n_points, k) at u (k,), by differences over 2 % of the ranges, inwards."""
        if u.tobytes() not in self._known:
            steps = np.where(u < 0.5, STEP, -STEP)
            named = self.fit.space.named
            curves, *moved = self.model([named(u), *(named(u + step) for step in np.diag(steps))])
            slopes = {
                name: np.column_stack([(there[name] - curves[name]) / d for there, d in zip(moved, steps, strict=True)])
                for name in self.fit.measured
            }
            self._known[u.tobytes()] = curves, slopes
        return self._known[u.tobytes()]

    def corrected_search(self, u: np.ndarray, exact: Curves) -> tuple[np.ndarray, bool]:
        """Coordinates (k,) of least chi^2 of the model and what it misses at u (k,) of its exact curves there.

        What the data say nothing of stays where it is: every coordinate is held at u with a standard deviation of its
        whole range, without which the trust region creeps. What is sought is the way from u: the trust region takes its
        first size from the length of the start, and from an estimate near all lower bounds it would never get away.

        A way at whose end the model fails is shortened. The second value tells that one was: the least may lie there.
        """
        fit, known, failures = self.fit, self(u)[0], []

        def residual(way: np.ndarray) -> np.ndarray:
            try:
                curves = self(u + way)[0]
            except PalpateError as failure:
                failures.append(failure)
                return np.full(len(fit.factor) + len(u), np.nan)
            misfit = fit.whiten({n: curves[n] + exact[n] - known[n] - fit.measured[n] for n in fit.measured})
            return np.append(misfit, way)

        def slope(way: np.ndarray) -> np.ndarray:
            return np.vstack([fit.whiten(self(u + way)[1]), np.eye(len(u))])

        start, bounds, tolerance = np.zeros_like(u), (-u, 1.0 - u), GAIN / fit.chi_square(exact)
        found = least_squares(residual, start, slope, bounds=bounds, ftol=tolerance, xtol=FINE, max_nfev=SEARCH)
        return np.clip(u + found.x, 0.0, 1.0), bool(failures)

    def moved(self, u: np.ndarray, v: np.ndarray) -> float:
        """How far the curves are apart between u and v (k,), in standard deviations a parameter."""
        there, here = self(v)[0], self(u)[0]
        apart = self.fit.whiten({name: there[name] - here[name] for name in self.fit.measured})
        return float(np.sqrt(apart @ apart / len(u)))


def confirm_and_correct(
    fit: WeightedFit, u: np.ndarray, confirm: Confirm, corrections: int, approximate: ConfirmAll | None = None
) -> Confirmation:
    """Run the forward model at u (k,) and improve u by it until it hardly moves against its uncertainty.

    Parameters
    ----------
    fit
        The problem with surrogates, covariances without the surrogates' error.
    corrections
        Largest number of improvements; each costs one run, and a search with the cheaper model.
    approximate
        A cheaper forward model, asked for several points at once. `confirm` when not given.

    Raises
    ------
    PalpateError
        When a model fails at u itself. Failures further on leave the best run, not settled.
    """
    cheaper = Cheaper(fit, approximate or (lambda points: [confirm(point) for point in points]))
    u = np.clip(u, 1e-6, 1 - 1e-6)
    runs: list[dict[str, Any]] = []
    least, settled = np.inf, False
    while not settled and len(runs) <= corrections:
        try:
            curves = confirm(fit.space.named(u))
            misfit = fit.chi_square(curves)
        except PalpateError:
            if not runs:
                raise
            break
        surrogate = fit.curves(u)
        error = {name: float(np.abs(curves[name] - surrogate[name]).max()) for name in fit.measured}
        runs.append({"parameters": fit.space.named(u), "chi_square": misfit, "surrogate_error_nm": error})
        if misfit < least:
            best, found, least = u, curves, misfit
        following, failed = cheaper.corrected_search(u, curves)
        settled = not failed and cheaper.moved(u, following) < STILL
        u = following
    return Confirmation(tangent_fit(fit, best, found, cheaper(best)[1]), best, found, settled, runs)


def tangent_fit(
    fit: WeightedFit, u: np.ndarray, curves: Mapping[str, np.ndarray], slopes: Mapping[str, np.ndarray]
) -> WeightedFit:
    """Put tangents at u, with slopes (n_points, k) in scaled coordinates, in place of the surrogates."""
    space = fit.space
    tangents = {}
    for name in fit.measured:
        slope = np.zeros((len(curves[name]), len(space.free)))
        slope[:, space.free] = slopes[name] / space.extent[space.free]
        tangents[name] = Tangent(space.physical(u)[0], curves[name], slope)
    return replace(fit, surrogates=tangents)
