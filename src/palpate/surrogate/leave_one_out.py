r"""The interpolation system as a whole: its condition number and its leave-one-out errors.

With the kernel matrix Phi, the polynomial columns P and A = [[Phi, P], [P^T, 0]], the weights of data a are the
first rows of A^-1 [a; 0], and leaving snapshot i out moves the interpolant at that snapshot to a value in error by

    e_i = w_i / (A^-1)_ii

(Rippa 1999, Adv. Comput. Math. 11, 193, eq. 15; with polynomials by the same block inverse).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

from palpate.errors import InputError
from palpate.surrogate.kernels import KERNELS

TRIALS = 100  # of lengths, for each parameter
WORST = 1e3  # in place of the logarithm of an error, where a system is too badly conditioned


class ConditionError(InputError):
    """The interpolation system is too badly conditioned to be solved to useful accuracy.

    Parameters
    ----------
    condition_number
        1-norm condition number that came.
    limit
        Largest one allowed.
    """

    def __init__(self, condition_number: float, limit: float, kernel: str, shape: float):
        self.condition_number, self.limit = condition_number, limit
        super().__init__(
            f"the {kernel} interpolation system with shape {shape:g} has condition number {condition_number:.1e}, "
            f"at most {limit:.1e} is allowed",
            remedy="use a smaller shape, shape 'loo' or another kernel, remove repeated snapshots, "
            "and give every parameter that varies enough levels",
        )


def system_inverse(points: np.ndarray, kernel: str, shape: float) -> tuple[np.ndarray, float]:
    """Inverse of A and its 1-norm condition number (infinite, with an inverse of NaN, when A is singular).

    Parameters
    ----------
    points : ndarray, shape (n, p)
        Centres, scaled to [0, 1].
    """
    n = len(points)
    columns = [np.ones((n, 1)), 2.0 * points - 1.0][: KERNELS[kernel].degree + 1]
    polynomial = np.hstack(columns)
    m = polynomial.shape[1]
    system = np.block(
        [[KERNELS[kernel].formula(cdist(points, points), shape), polynomial], [polynomial.T, np.zeros((m, m))]]
    )
    try:
        inverse = np.linalg.inv(system)
    except np.linalg.LinAlgError:
        return np.full_like(system, np.nan), np.inf
    return inverse, float(np.linalg.norm(system, 1) * np.linalg.norm(inverse, 1))


def leave_one_out(inverse: np.ndarray, data: np.ndarray) -> np.ndarray:
    """Errors e (n, k) = data - prediction without it, of `data` (n, k), from the inverse of A."""
    n = len(data)
    return inverse[:n, :n] @ data / np.diag(inverse)[:n, None]


def choose_shape(points: np.ndarray, data: np.ndarray, kernel: str, max_condition: float) -> float:
    """Length c of least leave-one-out error among those whose system is well conditioned.

    Twenty-five lengths from `shortest` to 20 (of parameters scaled to [0, 1]) are tried, evenly on a logarithmic scale.

    Parameters
    ----------
    points : ndarray, shape (n, p)
        Centres, scaled to [0, 1].
    data : ndarray, shape (n, k)
        Values at the centres.
    kernel
        Key of `palpate.surrogate.kernels.KERNELS`.
    max_condition
        Largest condition number allowed.

    Raises
    ------
    ConditionError
        If no length gives a well conditioned system.
    """
    best, chosen, least = np.inf, None, np.inf
    for shape in np.geomspace(shortest(points), 20.0, 25):
        inverse, condition = system_inverse(points, kernel, shape)
        least = min(least, condition)
        if condition <= max_condition:
            error = float(np.sum(leave_one_out(inverse, data) ** 2))
            if error < best:
                best, chosen = error, float(shape)
    if chosen is None:
        raise ConditionError(least, max_condition, kernel, shortest(points))
    return chosen


def shortest(points: np.ndarray) -> float:
    """Return the shortest length that is tried: 0.05, or how far points (n, p) lie from their nearest, if less."""
    nearest = np.sort(cdist(points, points), axis=1)[:, 1]
    return min(0.05, max(float(np.median(nearest)), 1e-4))


def choose_lengths(points: np.ndarray, data: np.ndarray, kernel: str, max_condition: float) -> np.ndarray:
    """Length (p,) for each parameter of least leave-one-out error, by Nelder and Mead from the best common length.

    Parameters
    ----------
    points, data, kernel, max_condition
        See `choose_shape`.

    Raises
    ------
    ConditionError
        If no common length gives a well conditioned system.
    """
    scaled = KERNELS[kernel].scaled
    start = choose_shape(points, data, kernel, max_condition) if scaled else 1.0

    def error(logarithms: np.ndarray) -> float:
        inverse, condition = system_inverse(points / np.exp(logarithms), kernel, 1.0)
        return float(np.log(np.sum(leave_one_out(inverse, data) ** 2))) if condition <= max_condition else WORST

    begin = np.full(points.shape[1], np.log(start))
    simplex = np.vstack([begin, begin + np.eye(len(begin))])
    options = {"initial_simplex": simplex, "xatol": 0.05, "fatol": 1e-3, "maxfev": TRIALS * len(begin)}
    return np.exp(minimize(error, begin, method="Nelder-Mead", options=options).x)
