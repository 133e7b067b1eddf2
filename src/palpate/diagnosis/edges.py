"""Which quantities of a fit lie at the edge of what is searched: a narrow grid looks like missing physics."""

from __future__ import annotations

import numpy as np

from palpate.diagnosis.fit import Fit
from palpate.mechanisms import MECHANISMS, Mechanism
from palpate.mechanisms.mechanism import Range

EDGE = 0.005  # of a range


def at_edges(fit: Fit) -> list[str]:
    """Return, in words, the quantities of an explanation that a wider search would move, with their values.

    At zero none can go further, nor can an effect where it vanishes.
    """
    problem = fit.problem
    u, own = problem.parts(fit.explanation, fit.z)
    names = [name for name, free in zip(problem.space.bounds, problem.space.free, strict=True) if free]
    found = []
    for name, x in zip(names, u, strict=True):
        lower, upper = problem.space.bounds[name]
        if x > 1.0 - EDGE or (x < EDGE and lower != 0.0):
            found.append(f"{name} {upper if x > 0.5 else lower:.3g}")
    for key, coordinates in own.items():
        for (name, searched), x in zip(MECHANISMS[key].searched(problem.scale).items(), coordinates, strict=True):
            if x > 1.0 - EDGE or (x < EDGE and not _ends(MECHANISMS[key], name, searched)):
                found.append(f"{key}.{name} {searched.upper if x > 0.5 else searched.lower:.3g}")
    return found


def _ends(mechanism: Mechanism, name: str, searched: Range) -> bool:
    """Return whether a quantity ends where its range does: at zero, or where the effect vanishes."""
    vanishes = mechanism.neutral.get(name, np.inf)
    return searched.lower == 0.0 or abs(vanishes - searched.lower) <= EDGE * (searched.upper - searched.lower)
