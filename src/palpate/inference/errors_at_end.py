"""What the end of a search tells of the errors: effects whose simulation errs, and variance between conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation, Problem
from palpate.inference.search_state import SearchState
from palpate.mechanisms import MECHANISMS

SHARES = (0.0, 0.01, 0.03, 0.1, 0.3)  # standard deviations that are tried, of the largest plausible value
LEAST_GAIN = 2.0  # of the log likelihood, above which a variance between conditions is accepted


def effects_at(problem: Problem, explanation: Explanation, end: SearchState) -> dict[str, np.ndarray]:
    """Return what those mechanisms add to the curves (n_all,) [nm] at the end of a search whose effects err.

    With a single amplitude that is the derivative by it, times the amplitude: the simulation errs in the amplitude, and
    where an effect saturates, as friction does once the surface sticks, its derivative differs from the effect itself.
    The amplitude counts from the value that the base model assumes, such as a friction of its own.
    """
    found = {}
    for key in [key for key in explanation if MECHANISMS[key].solver_scatter]:
        places = problem.places(explanation)[key]
        if len(places) == 1:
            ((name, assumed),) = _assumed(problem, key, end.u[: problem.material]).items()
            value, slope = problem.quantity(explanation, end.u, f"{key}.{name}")
            found[key] = end.tangent[:, places[0]] * (value - assumed) / slope
            continue
        smaller, rest = problem.without(explanation, end.u, key)
        (without,) = problem.model(smaller).curves([rest])
        if not isinstance(without, str):
            found[key] = end.curve - problem.stacked(without)
    return found


def _assumed(problem: Problem, key: str, z: np.ndarray) -> Mapping[str, float]:
    """Return the values of a mechanism that the base model assumes, at coordinates z (k,)."""
    mechanism = MECHANISMS[key]
    first = next(each for each in problem.conditions if mechanism.acts_under(each.tip))
    return mechanism.assumed(problem.forward.specification(z, first)) if mechanism.assumed else mechanism.neutral


def with_individual_amplitudes(fit: Fit) -> Fit:
    """Give each amplitude that varies the most likely variance between conditions."""
    for amplitude in fit.own:
        trials = list[tuple[float, Fit]]()
        for share in SHARES:
            between = {**fit.errors.between, str(amplitude): (share * fit.problem.largest(amplitude)) ** 2}
            trial = replace(fit, errors=replace(fit.errors, between=between))
            tangent = trial.whiten(fit.tangent)
            left = trial.white - tangent @ np.linalg.lstsq(tangent, trial.white, rcond=1e-10)[0]
            trials.append((-0.5 * float(left @ left) - trial.log_volume, trial))
        likeliest, alike = max(trials, key=lambda each: each[0]), trials[0]
        fit = (likeliest if likeliest[0] > alike[0] + LEAST_GAIN else alike)[1]
    return fit
