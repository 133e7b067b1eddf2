"""Densities of curves with the size of the law's discrepancy integrated over, by the eigenvectors of each kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import log_ndtr

from palpate.inference.discrepancy import SHAPES, SHARES, SIZES, Discrepancy, Size, log_prior

ALIKE = 1e-9  # of the square of a column, far above rounding


@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenvectors of a discrepancy beside the known errors: they serve all columns whose products are asked for.

    Parameters
    ----------
    factor : ndarray, shape (n, n)
        Lower Cholesky factor of the known errors.
    discrepancy
        None where the law is taken to be exact.
    """

    factor: np.ndarray
    discrepancy: Discrepancy | None

    @cached_property
    def basis(self) -> np.ndarray:
        """Whitened columns of the discrepancy (n, m)."""
        assert self.discrepancy is not None
        return solve_triangular(self.factor, self.discrepancy.columns, lower=True)

    @cached_property
    def of_kinds(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """For each of `SHAPES`: which columns act (m,), the modes' coefficients of these, and eigenvalues."""
        assert self.discrepancy is not None
        inner, found = self.basis.T @ self.basis, []
        for kind, own in SHAPES:
            deviations = self.discrepancy.deviations(own, kind)
            acts = deviations > 0.0
            scaled = deviations[acts, None] * inner[np.ix_(acts, acts)] * deviations[acts]
            values, vectors = np.linalg.eigh(scaled)
            found.append((acts, deviations[acts, None] * vectors, np.maximum(values, 0.0)))
        return found


@dataclass(frozen=True, eq=False)
class Marginal:
    r"""Products X' C^-1 X of some columns X under every size of the discrepancy, and what each size adds to a density.

    With the factor L of the known errors, W = L^-1 columns, and the coefficients' deviations s at a given `own`,

        C^-1 = C_0^-1 - C_0^-1 F (1/share^2 + F' C_0^-1 F)^-1 F' C_0^-1,        F = columns diag(s),

    (M. A. Woodbury 1950) becomes diagonal in `share` by the eigenvectors of F' C_0^-1 F.

    Attributes
    ----------
    sizes : ndarray of Size, shape (q,)
        At each node; one node of size zero where there is no discrepancy.
    log_prior : ndarray, shape (q,)
        Logarithm of the prior weight of each node.
    products : ndarray, shape (q, c, c)
        X' C^-1 X.
    half_log_det : ndarray, shape (q,)
        Half the logarithm of the determinant of C.
    """

    sizes: np.ndarray
    log_prior: np.ndarray
    products: np.ndarray
    half_log_det: np.ndarray

    @classmethod
    def of(cls, modes: Modes, columns: np.ndarray) -> Marginal:
        """Return the products of columns (n, c)."""
        white = solve_triangular(modes.factor, columns, lower=True)
        known, half = white.T @ white, float(np.log(np.diag(modes.factor)).sum())
        if modes.discrepancy is None:
            return cls(np.array([Size()], dtype=object), np.zeros(1), known[None], np.array([half]))
        outer, products, halves = modes.basis.T @ white, [], []
        for acts, coefficients, values in modes.of_kinds:
            along = coefficients.T @ outer[acts]
            grown = SHARES[:, None] ** 2 * values
            halves.append(half + 0.5 * np.log1p(grown).sum(axis=1))
            weights = SHARES[:, None] ** 2 / (1.0 + grown)
            products.append(known - (along.T * weights[:, None, :]) @ along)
        prior = log_prior(modes.discrepancy.law_error)
        return cls(SIZES, prior, np.concatenate(products), np.concatenate(halves))

    def with_data(self, columns: np.ndarray) -> Marginal:
        """Return the same with further data of unit variance, rows (d, c) of the same columns."""
        return replace(self, products=self.products + columns.T @ columns)

    def of_columns(self, places: Sequence[int]) -> Marginal:
        """Return the same for some of the columns."""
        return replace(self, products=self.products[:, places][:, :, places])

    def from_elsewhere(self, places: np.ndarray, moves: np.ndarray) -> Marginal:
        """Return the same with the first column where the coefficients of those at `places` have made `moves` (p,)."""
        moved = np.eye(self.products.shape[1])
        moved[places, 0] = -moves
        return replace(self, products=moved.T @ self.products @ moved)

    def log_densities(self, variance: float | np.ndarray, moves: bool = True, positive: bool = False) -> np.ndarray:
        """Return the log density (q,) of the first column at each node, the coefficients of the others integrated over.

        Constants of the number of points are left out.

        Parameters
        ----------
        variance
            Prior variance of the coefficients about zero, or of each (c - 1,).
        moves
            Whether the coefficients take their best values; else they stay at zero, and only their volume counts.
        positive
            Whether the last coefficient is positive, with half of a normal prior.
        """
        variance = np.broadcast_to(variance, self.products.shape[1] - 1)
        order = np.r_[1 : len(variance) + 1, 0]
        # One more keeps the last pivot positive where nothing is left; it is taken off again.
        factor = _factor(self.products[:, order][:, :, order] + np.diag(np.append(1.0 / variance, 1.0)))
        diagonal, last = np.diagonal(factor, axis1=1, axis2=2), len(variance) - 1
        squares = diagonal[:, -1] ** 2 - 1.0 if moves else self.products[:, 0, 0]
        volume = 2.0 * np.log(diagonal[:, :-1]).sum(axis=1) + np.log(variance).sum()
        found = -0.5 * (squares + volume) - self.half_log_det
        return found + np.log(2.0) + log_ndtr(factor[:, -1, last]) if positive else found


def _factor(precisions: np.ndarray) -> np.ndarray:
    """Return the factors of Cholesky (q, c, c); of columns alike to the last digits, as if they differed by `ALIKE`."""
    try:
        return np.linalg.cholesky(precisions)
    except np.linalg.LinAlgError:
        diagonal = np.diagonal(precisions, axis1=1, axis2=2)
        return np.linalg.cholesky(precisions + ALIKE * diagonal[:, None, :] * np.eye(diagonal.shape[1]))
