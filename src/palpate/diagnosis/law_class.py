"""What kind of physics a law's discrepancy points to, by the structure of its covariance, without a mechanism.

What obeys the scaling law of a sharp tip is shared by all tests of one normalised history: it is the law of the
material. What breaks it differs with the load: it has a length. What follows the clock and not the load is a drift of
the instrument, another one in every test. What sits where the load turns, and fades after that, belongs to the
controller. Each of these is a kind of the discrepancy (`palpate.inference.law_structure`); their evidences, beside that
of none, are compared with the same prior of the size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.linalg import cho_solve
from scipy.special import logsumexp

from palpate.data.measures import root_mean_square
from palpate.diagnosis.parts import halves
from palpate.inference.discrepancy import LENGTHS, OBEYS, OWN, largest_depths, power_of_evidence
from palpate.inference.estimates import law_discrepancy
from palpate.inference.explanation import DENSITY_ONE, Fit
from palpate.inference.law_structure import APART
from palpate.inference.marginal import Marginal
from palpate.inference.problem import Problem

CLASSES = ("scaling", "length", "clock", "reversal")
SMALLEST = 1e-9  # of the largest depth: before a delayed load acts there is none


def discrepancy(fit: Fit) -> dict[str, Any] | None:
    """Return size, class and place of the law's discrepancy in a fit; None where the law is taken to be exact.

    `parts` holds the root mean square of the most likely discrepancy in each segment of each test, as a share of the
    depth, the largest first.
    """
    size = law_discrepancy(fit)
    if size is None:
        return None
    likely = fit.errors.of_simulation @ cho_solve((fit.factor, True), fit.residual)
    largest = largest_depths(fit.problem.split(fit.curve), {})
    relative = likely / np.maximum(largest, SMALLEST * largest.max())
    rows = [
        {"condition": condition.name, "segment": segment, "part": part, "share": root_mean_square(relative[half])}
        for condition, segment, part, half in halves(fit.problem)
    ]
    return {**size, **law_class(fit), "parts": sorted(rows, key=lambda row: -row["share"])}


def law_class(fit: Fit) -> dict[str, Any]:
    """Return `class` and `class_probabilities` of what a fit leaves.

    The class is `undetermined` where the tests differ neither in load nor in duration, or where no class has a
    probability of one half.
    """
    if fit.errors.law is None:
        return {"class": "undetermined", "class_probabilities": {}}
    columns = np.column_stack([fit.residual, fit.tangent])
    marginal = Marginal.of(fit.modes, columns)
    density = marginal.log_densities(DENSITY_ONE)
    found = {"scaling": _log_evidence(marginal, density, [size.own == OBEYS for size in marginal.sizes])}
    for kind in CLASSES[1:]:
        kinds = LENGTHS if kind == "length" else (kind,)
        of_kind = [size.kind in kinds and size.own >= OWN[-1] for size in marginal.sizes]
        found[kind] = _log_evidence(marginal, density, of_kind)
    exact = Marginal.of(replace(fit.modes, discrepancy=None), columns)
    found["none"] = float(exact.log_densities(DENSITY_ONE)[0])
    weights = power_of_evidence(fit.errors.law) * np.array(list(found.values()))
    probabilities = dict(zip(found, np.exp(weights - logsumexp(weights)).tolist(), strict=True))
    best = max(probabilities, key=lambda name: probabilities[name])
    certain = probabilities[best] >= 0.5 and (best == "none" or _tells(fit.problem))
    return {"class": best if certain else "undetermined", "class_probabilities": probabilities}


def _tells(problem: Problem) -> bool:
    """Return whether tests with one tip differ in load, and in duration."""

    def differ(tip: str) -> bool:
        tests = [condition.protocol for condition in problem.conditions if condition.tip == tip]
        loads, durations = [test.largest_drive for test in tests], [float(test.knot_time[-1]) for test in tests]
        return max(loads) > APART * min(loads) and max(durations) > APART * min(durations)

    return any(differ(condition.tip) for condition in problem.conditions)


def _log_evidence(marginal: Marginal, density: np.ndarray, of_class: Sequence[bool]) -> float:
    """Return the log evidence of the sizes that belong to a class, of the log densities (q,) at all."""
    prior = marginal.log_prior[of_class]
    return float(logsumexp(prior + density[of_class]) - logsumexp(prior))
