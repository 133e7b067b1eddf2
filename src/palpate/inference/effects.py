"""What mechanisms add to the curves of a fit, where the simulated effect itself errs by `Mechanism.solver_scatter`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.inference.descent import Descent
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS


def effects_at(problem: Problem, explanation: Explanation, end: Descent) -> dict[str, np.ndarray]:
    """Return what those mechanisms add to the curves (n_all,) [nm] at the end of a search whose effects err.

    The error of an effect with one amplitude is one of this: where the effect saturates, as friction's does once the
    surface sticks, that is another curve than the effect itself. Where the study's own tip has some of it already, as
    friction of its own, the effect is what the mechanism changes.
    """
    found = {}
    for key in [key for key in explanation if MECHANISMS[key].solver_scatter]:
        places = problem.places(explanation)[key]
        if len(places) == 1:
            ((name, assumed),) = _assumed(problem, key, end.u[: problem.material]).items()
            value, slope = problem.quantity(explanation, end.u, f"{key}.{name}")
            found[key] = problem.stacked(end.slopes)[:, places[0]] * (value - assumed) / slope
            continue
        smaller, rest = problem.without(explanation, end.u, key)
        (without,) = problem.model(smaller).curves([rest])
        if not isinstance(without, str):
            found[key] = problem.stacked(end.curves) - problem.stacked(without)
    return found


def _assumed(problem: Problem, key: str, z: np.ndarray) -> Mapping[str, float]:
    """Return the values of a mechanism that the base model assumes, at coordinates z (k,)."""
    assumed, first = MECHANISMS[key].assumed, problem.conditions[0]
    return assumed(problem.forward.specification(z, first)) if assumed else MECHANISMS[key].neutral
