"""POD-RBF: modes of the snapshot curves, interpolated over the parameters by radial basis functions."""

from __future__ import annotations

import warnings
from numbers import Real
from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin
from sklearn.utils import Tags
from sklearn.utils.validation import check_is_fitted, validate_data

from palpate.errors import InputError
from palpate.surrogate.kernels import KERNELS
from palpate.surrogate.leave_one_out import (
    ConditionError,
    choose_lengths,
    choose_shape,
    leave_one_out,
    shortest,
    system_inverse,
)
from palpate.surrogate.pod import pod

NEAR = 0.05  # of a parameter's range, outside which a prediction comes with a warning; chosen


class PODRBF(MultiOutputMixin, RegressorMixin, BaseEstimator):
    r"""Surrogate of depth curves over material parameters.

    Every parameter is scaled to [0, 1] by its range in training (one that never varies is ignored), the curves are
    reduced to their POD coordinates, and each coordinate is interpolated by SciPy's `RBFInterpolator`:
    a(x) = sum_j w_j phi(|x - x_j|; c) + polynomial (Buljak and Maier 2011, Eng. Struct. 33, 492).

    Parameters
    ----------
    kernel
        ``linear`` r, ``cubic`` r^3, ``multiquadric`` sqrt(r^2 + c^2), ``gaussian`` exp(-(r/c)^2) or
        ``inverse_multiquadric`` 1/sqrt(r^2 + c^2). A linear polynomial goes with cubic, a constant with the others.
    shape
        Length c in scaled parameters; ``"loo"``: the length of least leave-one-out error; or ``"loo_each"``: a length
        for each parameter, likewise, where some matter more than others; not for a grid of few levels, where
        leave-one-out errors do not show the error between them.
    energy
        Fraction of the energy that the modes must keep, in (0, 1].
    n_modes
        Number of modes; overrides `energy`.
    max_condition
        Largest condition number (1-norm) allowed of the interpolation system.

    Attributes
    ----------
    shape_ : float
        Length c that was used; the geometric mean of ``loo_each``'s.
    lengths_ : ndarray
        That of each parameter that varies.
    condition_number_ : float
        1-norm condition number of the interpolation system.
    n_modes_ : int
        Number of modes kept.
    energy_ : ndarray
        Cumulative energy of all modes.
    loo_error_ : ndarray, shape (n_snapshots, n_points)
        Curve less its prediction from all other snapshots [nm], in closed form, the modes kept. On a grid it does not
        show the error between the levels, which may be several times larger.
    loo_rms_ : ndarray, shape (n_points,)
        Root mean square of `loo_error_` over the snapshots [nm].

    Raises
    ------
    InputError
        In `fit`: a constructor parameter out of its range, or no parameter that varies.
    ConditionError
        In `fit`: an interpolation system worse conditioned than `max_condition`.
    """

    def __init__(
        self,
        kernel: str = "multiquadric",
        shape: float | str = 0.5,
        energy: float = 1.0 - 1e-8,
        n_modes: int | None = None,
        max_condition: float = 1e12,
    ):
        self.kernel = kernel
        self.shape = shape
        self.energy = energy
        self.n_modes = n_modes
        self.max_condition = max_condition

    def fit(self, X: Any, y: Any, lengths: Any = None) -> PODRBF:
        """Fit to parameters X (n_snapshots, n_parameters) and curves y (n_snapshots, n_points) [nm].

        The `lengths` of an earlier fit to the same snapshots spare the search for them.
        """
        self._check_parameters()
        X, y = validate_data(self, X, y, multi_output=True, y_numeric=True, ensure_min_samples=2, dtype=float)
        self.single_output_ = y.ndim == 1
        curves = np.asarray(y, dtype=float).reshape(len(X), -1)
        self.lower_, self.upper_, self.varies_ = _ranges(X)
        self.pod_ = pod(curves, energy=self.energy, n_modes=self.n_modes)
        self.n_modes_, self.energy_ = len(self.pod_.modes), self.pod_.energy
        self.lengths_ = np.ones(self.varies_.sum())
        points, data = self._scale(X), self.pod_.reduce(curves)
        self.lengths_ = self._chosen_lengths(points, data) if lengths is None else np.asarray(lengths, dtype=float)
        self.shape_ = float(np.exp(np.mean(np.log(self.lengths_))))
        points = points / self.lengths_
        degree = KERNELS[self.kernel].degree
        inverse, self.condition_number_ = self._solvable(points, 1.0, self.shape_)
        self.interpolator_ = RBFInterpolator(points, data, kernel=self.kernel, epsilon=1.0, degree=degree)
        truncation = curves - self.pod_.expand(data)
        self.loo_error_ = self.pod_.expand(leave_one_out(inverse, data)) + truncation
        self.loo_rms_ = np.sqrt(np.mean(self.loo_error_**2, axis=0))
        return self

    def _chosen_lengths(self, points: np.ndarray, data: np.ndarray) -> np.ndarray:
        """Return the length of each parameter that varies, as `shape` says, for points (n, d) scaled to [0, 1]."""
        if self.shape == "loo_each":
            return choose_lengths(points, data, self.kernel, self.max_condition)
        if not KERNELS[self.kernel].scaled:
            return np.ones(points.shape[1])
        loo = self.shape == "loo"
        shape = choose_shape(points, data, self.kernel, self.max_condition) if loo else float(self.shape)
        return np.full(points.shape[1], shape)

    def check_points(self, X: np.ndarray) -> None:
        """Check that snapshots at parameters X (n_snapshots, n_parameters) can be interpolated with the stated shape.

        Raises
        ------
        InputError
            As `fit` would once the snapshots are there.
        """
        self._check_parameters()
        low, high, varies = _ranges(X)
        points = (X[:, varies] - low[varies]) / (high - low)[varies]
        length = shortest(points) if isinstance(self.shape, str) else float(self.shape)
        self._solvable(points, length, length)

    def _solvable(self, points: np.ndarray, length: float, shape: float) -> tuple[np.ndarray, float]:
        """Return the system's inverse and condition number; raises `ConditionError`, which names the `shape`."""
        inverse, condition = system_inverse(points, self.kernel, length)
        if not condition <= self.max_condition:
            raise ConditionError(condition, self.max_condition, self.kernel, shape)
        return inverse, condition

    def predict(self, X: Any) -> np.ndarray:
        """Curves (n, n_points) [nm] at parameters X (n, n_parameters); warns well outside the snapshots."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False, dtype=float)
        slack = NEAR * (self.upper_ - self.lower_)
        outside = ((self.lower_ - slack > X) | (self.upper_ + slack < X)) & self.varies_
        if outside.any():
            warnings.warn(
                f"{outside.any(axis=1).sum()} of {len(X)} points lie outside the range of the snapshots, where a "
                "surrogate knows nothing",
                stacklevel=2,
            )
        curves = self.evaluate(X)
        return curves[:, 0] if self.single_output_ else curves

    def evaluate(self, X: np.ndarray) -> np.ndarray:
        """Curves (n, n_points) [nm] of a fitted surrogate at valid X (n, n_parameters): `predict` for inner loops."""
        return self.pod_.expand(self.interpolator_(self._scale(X)))

    def jacobian(self, x: Any) -> np.ndarray:
        """Slope (n_points, n_parameters) of the curve at the parameters x (n_parameters,) [nm per unit of x].

        Central differences over 1e-5 of each training range; zero for parameters that never varied.
        """
        check_is_fitted(self)
        x = np.asarray(x, dtype=float)
        steps = 1e-5 * np.diag(self.upper_ - self.lower_)[self.varies_]
        ahead, behind = np.split(self.evaluate(np.vstack([x + steps, x - steps])), 2)
        slope = np.zeros((ahead.shape[1], len(x)))
        slope[:, self.varies_] = (ahead - behind).T / (2.0 * steps.sum(axis=1))
        return slope

    def __sklearn_tags__(self) -> Tags:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags

    def _scale(self, X: np.ndarray) -> np.ndarray:
        low, high = self.lower_[self.varies_], self.upper_[self.varies_]
        return (X[:, self.varies_] - low) / (high - low) / self.lengths_

    def _check_parameters(self) -> None:
        if self.kernel not in KERNELS:
            raise InputError(
                f"kernel {self.kernel!r} is not known", remedy=f"use one of: {', '.join(KERNELS)}", place="kernel"
            )
        if self.shape not in ("loo", "loo_each") and not (isinstance(self.shape, Real) and 0 < self.shape < np.inf):
            raise InputError(
                f"shape is {self.shape!r}", remedy="give a positive length, 'loo' or 'loo_each'", place="shape"
            )
        if not 0 < self.energy <= 1:
            raise InputError(f"energy is {self.energy!r}", remedy="give a fraction in (0, 1]", place="energy")
        if self.n_modes is not None and self.n_modes < 1:
            raise InputError(f"n_modes is {self.n_modes!r}", remedy="give a positive number", place="n_modes")


def _ranges(X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the least and the largest value of each parameter (d,), and whether it varies, as one of them must."""
    low, high = X.min(axis=0), X.max(axis=0)
    if not (high > low).any():
        raise InputError("no parameter varies among the snapshots", remedy="give one of them at least two levels")
    return low, high, high > low
