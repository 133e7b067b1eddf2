r"""Confirmation by the forward model, and the Gauss-Newton steps that free the estimate from the surrogate's error.

A surrogate that is right to half a per cent may still be wrong about the slope of a weak parameter. So the forward
model is run at the estimate u_0 and, by differences, for its own Jacobian G there; then

    u_{i+1} = argmin chi^2 of h(u_i) + G_i (u - u_i) within the bounds,

with h from the forward model and G_i brought up to date by Broyden's rank-one formula from each further run. The run
of least chi^2 counts, so a confirmation never makes an estimate worse.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palpate.calibration.polish import WeightedFit

Confirm = Callable[[dict[str, float]], Mapping[str, np.ndarray]]
ConfirmAll = Callable[[Sequence[dict[str, float]]], Sequence[Mapping[str, np.ndarray]]]
STEP = 0.02
STILL = 0.1


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
    runs
        For each run: `parameters`, `chi_square`, and `surrogate_error_nm`, the largest difference from the
        surrogate, by condition.
    """

    fit: WeightedFit
    u: np.ndarray
    curves: Mapping[str, np.ndarray]
    runs: list[dict[str, Any]]


def confirm_and_correct(
    fit: WeightedFit, u: np.ndarray, confirm: Confirm, corrections: int, approximate: ConfirmAll | None = None
) -> Confirmation:
    """Run the forward model at u (k,) and improve u by it until it moves by less than a tenth of its uncertainty.

    Parameters
    ----------
    fit
        The problem with surrogates, covariances without the surrogates' error.
    corrections
        Largest number of steps; each costs one run.
    approximate
        A cheaper forward model for the differences, asked for all points at once: one and one more for each free
        parameter. `confirm` when not given.
    """

    def run(at: np.ndarray) -> tuple[Mapping[str, np.ndarray], float]:
        curves = confirm(fit.space.named(at))
        surrogate = fit.curves(at)
        error = {name: float(np.abs(curves[name] - surrogate[name]).max()) for name in fit.measured}
        misfit = fit.chi_square(curves)
        runs.append({"parameters": fit.space.named(at), "chi_square": misfit, "surrogate_error_nm": error})
        return curves, misfit

    runs: list[dict[str, Any]] = []
    curves, misfit = run(u)
    slopes = differences(fit, u, approximate or (lambda points: [confirm(point) for point in points]))
    for _ in range(corrections):
        following = tangent_fit(fit, u, curves, slopes).solve([u])
        step = following - u
        moved = fit.whiten({name: slope @ step for name, slope in slopes.items()})
        if moved @ moved < STILL**2 * len(u):
            break
        there, misfit_there = run(following)
        slopes = {
            name: slope + np.outer(there[name] - curves[name] - slope @ step, step) / (step @ step)
            for name, slope in slopes.items()
        }
        if misfit_there < misfit:
            u, curves, misfit = following, there, misfit_there
    return Confirmation(tangent_fit(fit, u, curves, slopes), u, curves, runs)


def differences(fit: WeightedFit, u: np.ndarray, confirm_all: ConfirmAll) -> dict[str, np.ndarray]:
    """Slopes (n_points, k) in scaled coordinates by one-sided differences over 2 % of the ranges, into the bounds."""
    steps = np.where(u < 0.5, STEP, -STEP)
    curves, *moved = confirm_all([fit.space.named(u), *(fit.space.named(u + step) for step in np.diag(steps))])
    return {
        name: np.column_stack([(there[name] - curves[name]) / step for there, step in zip(moved, steps, strict=True)])
        for name in fit.measured
    }


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
