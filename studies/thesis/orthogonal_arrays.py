"""Taguchi's orthogonal arrays: every pair of columns holds every pair of levels equally often (strength 2).

The thesis' modified L16 and its L27 are the first columns of the parents that pydoe tabulates. The interaction of two
columns with s levels has (s - 1)^2 degrees of freedom. In these arrays they lie in the columns that are sums of the
two; a factor assigned to such a column, or left in the error term, carries the interaction too: it is aliased.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError
from studies.thesis.libraries import library

PARENTS = {"L16": "L16(4^5)", "L27": "L27(2^1 3^12)"}  # pydoe's name of the second is wrong: 13 columns of 3 levels


@dataclass(frozen=True, eq=False)
class OrthogonalArray:
    """Levels of each factor in each experiment.

    Parameters
    ----------
    factors
        Names, one a column.
    levels : ndarray of int, shape (runs, factors)
        Index of the level, from 0.

    Raises
    ------
    InputError
        When the array does not have strength 2.
    """

    factors: tuple[str, ...]
    levels: np.ndarray

    def __post_init__(self) -> None:
        if self.levels.shape[1] != len(self.factors):
            raise InputError(
                f"{len(self.factors)} factors for {self.levels.shape[1]} columns", remedy="name every column"
            )
        if self.strength < 2:
            raise InputError("two columns hold their pairs of levels unequally often", remedy="use an orthogonal array")

    @classmethod
    def of(cls, name: str, factors: Sequence[str]) -> OrthogonalArray:
        """Return the first columns of the parent array `name`, one for each factor."""
        if name not in PARENTS:
            raise InputError(f"array {name!r} is not known", remedy=f"use one of: {', '.join(PARENTS)}", place="array")
        parent = np.asarray(library("pydoe").get_orthogonal_array(PARENTS[name]), dtype=int)
        if len(factors) > parent.shape[1]:
            raise InputError(
                f"{name} has {parent.shape[1]} columns for {len(factors)} factors", remedy="use a larger array"
            )
        return cls(tuple(factors), parent[:, : len(factors)])

    @property
    def strength(self) -> int:
        """Largest t up to 3 for which every t columns hold every combination of their levels equally often."""
        for t in (1, 2, 3):
            for columns in itertools.combinations(range(len(self.factors)), t):
                counts = np.unique(self.levels[:, columns], axis=0, return_counts=True)[1]
                combinations = np.prod([len(np.unique(self.levels[:, k])) for k in columns])
                if len(counts) != combinations or len(set(counts)) != 1:
                    return t - 1
        return 3

    def points(self, values: Mapping[str, Sequence[float]]) -> list[dict[str, float]]:
        """Return the experiments, each factor at the value of its level.

        Raises
        ------
        InputError
            When a factor does not have as many values as the array has levels.
        """
        for k, name in enumerate(self.factors):
            needed = self.levels[:, k].max() + 1
            if len(values[name]) != needed:
                raise InputError(
                    f"{name} has {len(values[name])} levels, the array has {needed}", remedy="give one for each level"
                )
        return [
            {name: values[name][level] for name, level in zip(self.factors, row, strict=True)} for row in self.levels
        ]

    def aliases(self) -> dict[str, list[tuple[str, str, float]]]:
        """Return the two-factor interactions that are aliased with each factor's main effect.

        Returns
        -------
        dict
            For each factor, (factor, factor, share): the share of the interaction's variance, all its degrees of
            freedom equally large, that the ANOVA attributes to the factor. An array of 16 or 27 runs has too few
            degrees of freedom for interactions of their own, so the rest lies in the error term.
        """
        found: dict[str, list[tuple[str, str, float]]] = {name: [] for name in self.factors}
        contrasts = [_contrasts(self.levels[:, k]) for k in range(len(self.factors))]
        for i, j in itertools.combinations(range(len(self.factors)), 2):
            product = np.einsum("ra,rb->rab", contrasts[i], contrasts[j]).reshape(len(self.levels), -1)
            product /= np.linalg.norm(product, axis=0)
            for k, name in enumerate(self.factors):
                share = float(np.sum((contrasts[k].T @ product) ** 2) / product.shape[1])
                if k not in (i, j) and share > 1e-9:
                    found[name].append((self.factors[i], self.factors[j], share))
        return found


def _contrasts(column: np.ndarray) -> np.ndarray:
    """Return orthonormal contrasts (runs, levels - 1) of one factor."""
    count = column.max() + 1
    centred = np.eye(count) - 1.0 / count
    return np.linalg.qr(centred[column])[0][:, : count - 1]
