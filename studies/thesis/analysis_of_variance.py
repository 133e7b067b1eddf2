r"""Analysis of variance of an orthogonal design: main effects alone, the remainder is the error.

With L levels a factor, n_l runs at level l, and y the response,

    SS_factor = sum_l n_l (mean_l - mean)^2,   DF = L - 1,   MS = SS / DF,   F = MS / MS_error,

and the error is what the main effects leave of the total (Montgomery, Design and Analysis of Experiments, section
3.3). In a design of strength 2 these sums of squares add up, so adjusted and sequential ones are the same. The error
holds the interactions, not noise: simulations repeat exactly, so p only ranks the factors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import f as fisher

from palpate.errors import InputError
from studies.thesis.orthogonal_arrays import OrthogonalArray


@dataclass(frozen=True)
class Effect:
    """One row of an ANOVA table.

    Parameters
    ----------
    freedom
        Degrees of freedom.
    square, mean_square
        Sum of squares, and that divided by `freedom`, in the square of the response's unit.
    ratio, p_value
        F and the probability of a larger one were there no effect; NaN in the rows of the error and the total.
    contribution
        Per cent of the total sum of squares.
    """

    freedom: int
    square: float
    mean_square: float
    ratio: float
    p_value: float
    contribution: float


@dataclass(frozen=True)
class Anova:
    """An ANOVA table, and the mean response at each level.

    Parameters
    ----------
    effects
        `Effect` of each factor, then of ``error`` and ``total``.
    means
        Mean response at each level of each factor.
    """

    effects: Mapping[str, Effect]
    means: Mapping[str, tuple[float, ...]]

    def rows(self) -> list[dict[str, float | str]]:
        """Return the table as it is printed."""
        return [
            {
                "source": name,
                "DF": effect.freedom,
                "SS": effect.square,
                "MS": effect.mean_square,
                "F": effect.ratio,
                "p": effect.p_value,
                "contribution_percent": effect.contribution,
            }
            for name, effect in self.effects.items()
        ]


def anova(design: OrthogonalArray, response: np.ndarray) -> Anova:
    """Analyse the `response` (runs,) of an orthogonal design.

    Raises
    ------
    InputError
        When response and design differ in length, the response is the same in all runs, or the factors leave no degree
        of freedom for the error.
    """
    response = np.asarray(response, dtype=float)
    runs = len(design.levels)
    if response.shape != (runs,) or not np.all(np.isfinite(response)):
        raise InputError(f"the response has shape {response.shape}, expected ({runs},)", remedy="give one each run")
    if np.ptp(response) == 0.0:
        raise InputError(
            f"the response is {response[0]:g} in all runs",
            remedy="analyse one that the factors change",
            place="response",
        )
    mean = response.mean()
    total = float(np.sum((response - mean) ** 2))
    means, squares, freedoms = {}, {}, {}
    for k, name in enumerate(design.factors):
        counts = np.bincount(design.levels[:, k])
        by_level = np.bincount(design.levels[:, k], weights=response) / counts
        means[name] = tuple(map(float, by_level))
        squares[name], freedoms[name] = float(np.sum(counts * (by_level - mean) ** 2)), len(counts) - 1
    left = runs - 1 - sum(freedoms.values())
    if left < 1:
        raise InputError("the factors leave no degree of freedom for the error", remedy="use a larger array")
    error = max(total - sum(squares.values()), 0.0)
    effects = {name: effect(freedoms[name], squares[name], error / left, left, total) for name in design.factors}
    nan = float("nan")
    effects["error"] = Effect(left, error, error / left, nan, nan, 100 * error / total)
    effects["total"] = Effect(runs - 1, total, nan, nan, nan, 100.0)
    return Anova(effects, means)


def effect(freedom: int, square: float, error: float, error_freedom: int, total: float) -> Effect:
    """Return the row of a factor from its sum of squares and the error's mean square.

    Parameters
    ----------
    freedom, square
        Degrees of freedom and sum of squares of the factor.
    error, error_freedom
        Mean square of the error, and its degrees of freedom.
    total
        Sum of squares of the whole response.
    """
    mean_square = square / freedom
    ratio = mean_square / error if error > 0 else float("inf")
    return Effect(
        freedom,
        square,
        mean_square,
        ratio,
        float(fisher.sf(ratio, freedom, error_freedom)),
        100 * square / total,
    )
