"""What kind of physics a law's discrepancy points to, by the structure of its covariance, without a mechanism.

What obeys the scaling law of a sharp tip is shared by all tests of one normalised history: it is the law of the
material. What breaks it differs with the load: it has a length. What follows the clock and not the load is a drift of
the instrument, another one in every test. What sits where the load turns, and fades after that, belongs to the
controller. Each of these is a covariance; their evidences, beside that of none, are compared at the same parameters
with the same prior of the size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import block_diag, cho_solve
from scipy.special import logsumexp

from palpate.inference.discrepancy import Discrepancy, Marginal, correlation_factor
from palpate.inference.estimates import law_discrepancy
from palpate.inference.explanation import DENSITY_ONE, Fit
from palpate.inference.problem import Problem
from palpate.study.prescribed_segments import segments
from palpate.study.protocol import Protocol

CLASSES = ("scaling", "length", "clock", "reversal")
CLOCK = 0.3  # of a test's duration, over which a drift forgets
FADES = 0.1  # of the time since the load turned, over which the duration of a segment counts
APART = 1.2  # ratio of loads, or of durations, from which on tests tell a length from the law, or a clock from both
PRIOR = np.log(1.0 / 5.0)  # of each class, none among them


def discrepancy(fit: Fit) -> dict[str, Any] | None:
    """Return size, class and place of the law's discrepancy in a fit; None where the law is taken to be exact.

    `parts` holds the root mean square of the most likely discrepancy in each segment of each test, as a share of the
    depth, the largest first.
    """
    size = law_discrepancy(fit)
    if size is None:
        return None
    rows, first, likely = [], 0, fit.errors.of_simulation @ cho_solve((fit.factor, True), fit.residual)
    for condition in fit.problem.conditions:
        curve = fit.problem.split(fit.curve)[condition.name]
        relative = likely[first : first + len(curve)] / np.maximum.accumulate(np.abs(curve))
        for segment, where in segments(condition.protocol).items():
            for part, half in zip(("early", "late"), np.array_split(np.flatnonzero(where), 2), strict=True):
                share = float(np.sqrt(np.mean(relative[half] ** 2)))
                rows.append({"condition": condition.name, "segment": segment, "part": part, "share": share})
        first += len(curve)
    return {**size, **law_class(fit), "parts": sorted(rows, key=lambda row: -row["share"])}


def law_class(fit: Fit) -> dict[str, Any]:
    """Return `class` and `class_probabilities` of what a fit leaves.

    The class is `undetermined` where the tests differ neither in load nor in duration, or where no class has a
    probability of one half.
    """
    if fit.errors.law is None:
        return {"class": "undetermined", "class_probabilities": {}}
    found = {name: _log_evidence(fit, _structure(fit, name)) for name in CLASSES}
    found["none"] = _log_evidence(fit, None)
    total = logsumexp(list(found.values()))
    probabilities = {name: float(np.exp(value - total)) for name, value in found.items()}
    best = max(probabilities, key=lambda name: probabilities[name])
    certain = probabilities[best] >= 0.5 and (best == "none" or _tells(fit.problem))
    return {"class": best if certain else "undetermined", "class_probabilities": probabilities}


def _tells(problem: Problem) -> bool:
    """Return whether tests of one normalised history differ in load, and others in duration."""
    loads = [condition.protocol.largest_drive for condition in problem.conditions]
    durations = [float(condition.protocol.knot_time[-1]) for condition in problem.conditions]
    return max(loads) > APART * min(loads) and max(durations) > APART * min(durations)


def _log_evidence(fit: Fit, law: Discrepancy | None) -> float:
    """Return the log evidence of the curves with this discrepancy in place of the fit's."""
    columns = np.column_stack([fit.residual, fit.tangent])
    marginal = Marginal.of(fit.factor_of_known, law, columns)
    return float(logsumexp(marginal.log_prior + marginal.log_densities(DENSITY_ONE)))


def _structure(fit: Fit, name: str) -> Discrepancy:
    """Return the discrepancy of a class, without a size yet."""
    problem, law = fit.problem, fit.errors.law
    assert law is not None
    protocols = [condition.protocol for condition in problem.conditions]
    curves = problem.split(fit.curve)
    if name in ("scaling", "length"):
        return Discrepancy.of(protocols, name == "scaling" and problem.sharp, curves, law.law_error, problem.shares)
    largest = float(np.mean([np.abs(curve).max() for curve in curves.values()]))
    factor = _of_clock if name == "clock" else _of_reversals
    alone = block_diag(*(largest * factor(protocol) for protocol in protocols))
    return Discrepancy(np.empty((len(alone), 0)), alone, law.scale, law.law_error)


def _of_clock(protocol: Protocol) -> np.ndarray:
    """Return columns (n_points, m) of a walk with the clock that begins at zero."""
    time = protocol.sample_time / protocol.knot_time[-1]
    apart = np.subtract.outer(time, time) / CLOCK
    return correlation_factor(np.outer(time, time) ** 0.5 * np.exp(-0.5 * apart**2))


def _of_reversals(protocol: Protocol) -> np.ndarray:
    """Return columns (n_points, r), one for each corner of the history, that fade after it."""
    time, knots = protocol.sample_time, protocol.knot_time
    found = []
    for before, corner, after in zip(knots[:-2], knots[1:-1], knots[2:], strict=True):
        since = (time - corner) / (FADES * min(corner - before, after - corner))
        found.append(np.where(since >= 0.0, np.exp(-np.maximum(since, 0.0)), 0.0))
    return np.column_stack(found) if found else np.zeros((len(time), 1))
