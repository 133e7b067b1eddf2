"""Levels of a snapshot grid from an analysis of variance: fewer for factors that matter less.

The thesis decides by eye; its two decisions (chapter 4: 4 x 4 x 4 to 3 x 4 x 3; chapter 5: six factors to
3 x 4 x 4 x 3 x 2 x 1) follow from one rule:

    four levels    to a factor that contributes at least a quarter of the variance,
    three          to one that contributes at least one per cent,
    two            to one that contributes less but is significant (p < 0.05),
    one            to all others: they are held at the middle of their range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from palpate.errors import InputError
from studies.thesis.analysis_of_variance import Anova

LARGE, SMALL = 25.0, 1.0  # per cent of the variance, see above
SIGNIFICANT = 0.05  # p-value, likewise


def level_counts(analysis: Anova) -> dict[str, int]:
    """Return the number of levels of each factor."""
    counts = {}
    for name in analysis.means:
        effect = analysis.effects[name]
        if effect.contribution >= LARGE:
            counts[name] = 4
        elif effect.contribution >= SMALL:
            counts[name] = 3
        else:
            counts[name] = 2 if effect.p_value < SIGNIFICANT else 1
    return counts


def reduce_levels(levels: Mapping[str, Sequence[float]], analysis: Anova) -> dict[str, tuple[float, ...]]:
    """Return evenly spaced levels over the range of `levels`, as many for each factor as the analysis says.

    Raises
    ------
    InputError
        When the analysis does not have the factors of the grid.
    """
    counts = level_counts(analysis)
    if set(counts) != set(levels):
        raise InputError("the analysis is of other factors than the grid's", remedy="analyse the same parameters")
    reduced = {}
    for name, values in levels.items():
        low, high = min(values), max(values)
        even = np.linspace(low, high, counts[name]) if counts[name] > 1 else np.array([0.5 * (low + high)])
        reduced[name] = tuple(float(f"{value:.6g}") for value in even)
    return reduced
