r"""Confirmation by the forward model, and the steps that free the estimate from the surrogate's error.

A surrogate that is right to half a per cent may still be wrong about the slope of a weak parameter, and one over wide
ranges is off by tens of nanometres. So the forward model f is run at the estimate u_0, and a cheaper one, c, such as a
coarser mesh, takes the surrogate's place, with what it misses there added:

    u_{i+1} = argmin chi^2 of c(u) + f(u_i) - c(u_i) + T (u - u_i) within the bounds.

What c misses hardly depends on u, so that T begins as zero, and a few runs of f settle the estimate, however long and
bent its way was. Where the data hardly tell parameters apart, that little may be enough to hold it in a wrong place: an
estimate that stays is only believed when it stays with the tilt T of f - c as well, by differences. The run of least
chi^2 counts: a confirmation never makes an estimate worse.

Source: additive corrections of zeroth and first order of a model hierarchy, Eldred, Giunta & Collis, AIAA 2004-4457.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from palpate.calibration.polish import WeightedFit
from palpate.errors import PalpateError

Curves = Mapping[str, np.ndarray]
Model = Callable[[Sequence[dict[str, float]]], Sequence[Curves]]
STEP = 0.02
STILL = 0.3
SEARCH = 20
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
        Whether the last search, with the tilt, met no failure and moved the curves by less than 0.3 standard deviations
        a parameter.
    runs
        For each run: `parameters`, `chi_square`, and `surrogate_error`, the largest difference from the
        surrogate, by condition, in the unit of what answers.
    """

    fit: WeightedFit
    u: np.ndarray
    curves: Curves
    settled: bool
    runs: list[dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Point:
    """Where the forward model was run.

    Attributes
    ----------
    u : ndarray, shape (k,)
        Scaled coordinates.
    curves
        Of every condition [nm].
    slopes
        Of the curves of the fitted conditions (n_points, k) [nm], the cheaper model's until the forward model's own are
        known.
    misfit
        chi^2.
    """

    u: np.ndarray
    curves: Curves
    slopes: Curves
    misfit: float


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
    model: Model
    _known: dict[bytes, tuple[Curves, Curves]] = field(default_factory=dict, repr=False)

    def __call__(self, u: np.ndarray) -> tuple[Curves, Curves]:
        """Curves and slopes at u (k,), see `differences`."""
        if u.tobytes() not in self._known:
            self._known[u.tobytes()] = differences(self.fit, self.model, u)
        return self._known[u.tobytes()]

    def corrected_search(self, here: Point, tilt: Curves) -> tuple[np.ndarray, bool]:
        """Coordinates (k,) of least chi^2 of the model and what it misses, known at one point by value and tilt.

        What the data say nothing of stays where it is: every coordinate is held with a standard deviation of its whole
        range, without which the trust region creeps. What is sought is the way from the point: the trust region takes
        its first size from the length of the start, and from an estimate near all lower bounds it would never get away.

        A way at whose end the model fails is shortened. The second value tells whether none was: the least may lie
        there.
        """
        fit, u, failures = self.fit, here.u, []
        offset = {name: here.curves[name] - self(u)[0][name] - fit.measured[name] for name in fit.measured}

        def residual(way: np.ndarray) -> np.ndarray:
            try:
                curves = self(u + way)[0]
            except PalpateError as failure:
                failures.append(failure)
                return np.full(len(fit.factor) + len(u), np.nan)
            misfit = fit.whiten({name: curves[name] + offset[name] + tilt[name] @ way for name in fit.measured})
            return np.append(misfit, way)

        def slope(way: np.ndarray) -> np.ndarray:
            slopes = self(u + way)[1]
            return np.vstack([fit.whiten({name: slopes[name] + tilt[name] for name in fit.measured}), np.eye(len(u))])

        start, bounds, tolerance = np.zeros_like(u), (-u, 1.0 - u), GAIN / here.misfit
        found = least_squares(residual, start, slope, bounds=bounds, ftol=tolerance, xtol=FINE, max_nfev=SEARCH)
        return np.clip(u + found.x, 0.0, 1.0), not failures

    def still(self, u: np.ndarray, v: np.ndarray) -> bool:
        """Return whether the curves hardly move between u and v (k,), by standard deviations a parameter."""
        there, here = self(v)[0], self(u)[0]
        apart = self.fit.whiten({name: there[name] - here[name] for name in self.fit.measured})
        return bool(apart @ apart < STILL**2 * len(u))


def confirm_and_correct(
    fit: WeightedFit,
    u: np.ndarray,
    confirm: Model,
    corrections: int,
    approximate: Model | None = None,
    report: Callable[[str], None] = print,
) -> Confirmation:
    """Run the forward model at u (k,) and improve u by it until it hardly moves against its uncertainty.

    Parameters
    ----------
    fit
        The problem with surrogates, covariances without the surrogates' error.
    confirm
        The forward model. It is run at one point at a time, for every condition that anyone asks its curves for, and
        for its slopes at several, for the fitted conditions.
    corrections
        Largest number of improvements; each costs one run, and a search with the cheaper model.
    approximate
        A cheaper forward model. `confirm` when not given.
    report
        Told how it goes on; a run and its search may take a minute.

    Raises
    ------
    PalpateError
        When a model fails at u itself. Failures further on leave the best run, not settled.
    """
    cheaper = Cheaper(fit, approximate or confirm)
    runs: list[dict[str, Any]] = []

    def run(u: np.ndarray) -> Point:
        curves, surrogate = confirm([fit.space.named(u)])[0], fit.curves(u)
        error = {name: float(np.abs(curves[name] - surrogate[name]).max()) for name in fit.measured}
        misfit = fit.chi_square(curves)
        runs.append({"parameters": fit.space.named(u), "chi_square": misfit, "surrogate_error": error})
        report(f"forward model, run {len(runs)} of {corrections + 1} at most: chi-square {misfit:.4g}")
        return Point(u, curves, cheaper(u)[1], misfit)

    best = here = run(np.clip(u, 1e-6, 1 - 1e-6))
    tilt: Curves = {name: np.zeros_like(slope) for name, slope in here.slopes.items()}
    settled = False
    with suppress(PalpateError):
        while True:
            following, sound = cheaper.corrected_search(here, tilt)
            if sound and cheaper.still(here.u, following):
                report("the estimate stays; the forward model's own slopes are asked whether it does by them")
                here = replace(here, slopes=differences(fit, confirm, here.u)[1])
                best = min(here, best, key=lambda point: point.misfit)
                tilt = {name: here.slopes[name] - slope for name, slope in cheaper(here.u)[1].items()}
                following, sound = cheaper.corrected_search(here, tilt)
                settled = sound and cheaper.still(here.u, following)
            if settled or len(runs) > corrections:
                break
            here = run(following)
            best = min(here, best, key=lambda point: point.misfit)
    return Confirmation(tangent_fit(fit, best.u, best.curves, best.slopes), best.u, best.curves, settled, runs)


def differences(fit: WeightedFit, model: Model, u: np.ndarray) -> tuple[Curves, Curves]:
    """Curves (n_points,) and slopes (n_points, k) at u (k,) by differences over 2 % of the ranges, inwards [nm].

    Raises
    ------
    PalpateError
        When the model fails at one of these points.
    """
    named, steps = fit.space.named, np.where(u < 0.5, STEP, -STEP)
    curves, *moved = model([named(u), *(named(u + step) for step in np.diag(steps))])
    slopes = {
        name: np.column_stack([(there[name] - curves[name]) / d for there, d in zip(moved, steps, strict=True)])
        for name in fit.measured
    }
    return {name: curves[name] for name in fit.measured}, slopes


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
