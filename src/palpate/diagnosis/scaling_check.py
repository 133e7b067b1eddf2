"""The exact scaling law of a sharp tip: a test that needs no material model.

A sharp cone on a homogeneous body has no length, so two tests whose load histories are proportional, P_2(t) = k P_1(t),
have h_2(t) = sqrt(k) h_1(t), whatever the material's law. Where the recordings break this, a length (rounding, film,
size effect, zero point) or the instrument (frame, drift) is missing, not a better law of the material.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from scipy.stats import chi2
from scipy.stats import f as variance_ratio

from palpate.inference.explanation import Fit
from palpate.study.protocol import LOAD, Protocol

DEGREE = 2  # of the polynomial in the difference of two tests
SAME = 1e-6  # relative difference of times and loads that count as equal


def similarity(fit: Fit) -> list[dict[str, Any]]:
    """Test the scaling law on every pair of conditions with proportional load histories.

    Returns
    -------
    list
        For each pair `conditions`, `difference_percent` (mean of h_2 / sqrt(k) over h_1, less one) and `p_value` of a
        test with the difference's mean and slow trends; noise and site scatter are included, a model is not needed.
        Fisher's distribution allows for the few replicates from which the scatter between sites is estimated.
    """
    problem = fit.problem
    repeats = sum(len(problem.observed[c.name].response) - 1 for c in problem.conditions)
    terms = DEGREE + 1
    under_noise = variance_ratio(terms, repeats) if problem.replicated else chi2(terms, scale=1 / terms)
    blocks, found = fit.errors.blocks, []
    for (i, one), (j, two) in itertools.combinations(enumerate(problem.conditions), 2):
        if not proportional(one.protocol, two.protocol):
            continue
        k = two.protocol.max_load / one.protocol.max_load
        first, second = (problem.observed[c.name].mean for c in (one, two))
        difference = second / np.sqrt(k) - first
        covariance = blocks[i] + blocks[j] / k
        trends = np.vander(np.linspace(-1, 1, len(first)), terms) * first[:, None]
        solved = np.linalg.solve(covariance, np.column_stack([trends, difference]))
        information, score = trends.T @ solved[:, :-1], trends.T @ solved[:, -1]
        statistic = float(score @ np.linalg.solve(information, score))
        deep = first > 0.05 * first.max()
        found.append(
            {
                "conditions": [one.name, two.name],
                "difference_percent": float(100 * np.mean(difference[deep] / first[deep])),
                "p_value": float(under_noise.sf(statistic / terms)),
            }
        )
    return sorted(found, key=lambda row: row["p_value"])


def proportional(one: Protocol, two: Protocol) -> bool:
    """Return whether two load histories differ by a factor alone, and are sampled at the same times."""
    if one.control != LOAD or two.control != LOAD:
        return False
    if len(one.sample_time) != len(two.sample_time) or not np.allclose(one.sample_time, two.sample_time, rtol=SAME):
        return False
    same_shape = np.allclose(one.sample_load / one.max_load, two.sample_load / two.max_load, atol=SAME)
    return bool(same_shape and one.max_load != two.max_load)
