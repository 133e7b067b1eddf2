"""The joint posterior of the effects that studies on one instrument share, over all sets of mechanisms.

Sets that differ in other effects alone count together, each with its probability. The amplitudes of a set that was not
fitted are those to first order; one that was estimated by an exchange counts with its probability alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from palpate.diagnosis.diagnose import DiagnosisOutcome
from palpate.diagnosis.diagnosis_result import summary
from palpate.diagnosis.explanations import Members, inclusion
from palpate.diagnosis.over_sets import draws_of
from palpate.diagnosis.screen import Screen
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.instrument_prior import JointAmplitudes, pooled_by_shared
from palpate.models.coordinates import Coordinate

NARROWEST = 1e-5  # standard deviation of an amplitude that lies on a limit, in widths of its range


def instrument_posterior(
    diagnosis: DiagnosisOutcome, screen: Screen, shares: Sequence[str], rng: np.random.Generator
) -> dict[str, Any]:
    """Return what `instrument.json` says of the mechanisms that a study `shares`: quantities, inclusion and sets.

    The quantities have the ranges that give their coordinates. Each set has its probability, mean and covariance of the
    coordinates of its amplitudes and, of the likeliest set of all mechanisms, their medians and 95 % intervals.

    Parameters
    ----------
    diagnosis
        The sets of all mechanisms, with their fits.
    screen
        Effects of the mechanisms that were considered.
    rng
        Source of the draws from posteriors.
    """
    problem, sets = diagnosis.base.fit.problem, diagnosis.sets
    coordinates = {each.name: each for key in shares for each in _searched(problem, key)}
    every_set, likeliest = list[tuple[Members, float, JointAmplitudes | None]](), dict[Members, np.ndarray]()
    for members, probability in sets.probabilities().items():
        shared = members.intersection(shares)
        if not shared or not probability or sets.is_exchanged(members):
            every_set.append((members, probability, None))
            continue
        drawn, every = draws_of(sets, members, probability, screen, rng)
        names = tuple(name for name in coordinates if name.split(".")[0] in shared)
        draws = drawn[:, [every.index(name) for name in names]]
        spread = np.cov(draws.T).reshape(len(names), -1) + NARROWEST**2 * np.eye(len(names))
        every_set.append((members, probability, JointAmplitudes(names, draws.mean(axis=0), spread)))
        likeliest.setdefault(shared, draws)
    probabilities, amplitudes = pooled_by_shared(every_set, frozenset(shares))
    rows = []
    for shared, probability in sorted(probabilities.items(), key=lambda each: -each[1]):
        row: dict[str, Any] = {"mechanisms": sorted(shared), "probability": probability}
        if found := amplitudes.get(shared):
            row |= {"quantities": list(found.names), "mean": found.mean.tolist()}
            row |= {"covariance": found.covariance.tolist()}
            columns = zip(found.names, likeliest[shared].T, strict=True)
            row["estimates"] = {name: summary(coordinates[name].physical(column)) for name, column in columns}
        rows.append(row)
    return {
        "shares": sorted(shares),
        "inclusion": dict.fromkeys(sorted(shares), 0.0) | inclusion(probabilities),
        "quantities": [_quantity(each, problem) for each in coordinates.values()],
        "sets": rows,
    }


def _searched(problem: Problem, key: str) -> Sequence[Coordinate]:
    return problem.coordinates((key,)).free[problem.material :]


def _quantity(coordinate: Coordinate, problem: Problem) -> dict[str, Any]:
    key, name = coordinate.name.split(".")
    units = {each.name: each.unit for each in MECHANISMS[key].parameters}
    unit = units.get(name) or MECHANISMS[key].searched(problem.scale)[name].unit
    lower, upper, typical = coordinate.lower, coordinate.upper, coordinate.typical
    return {"name": coordinate.name, "unit": unit, "lower": lower, "upper": upper, "typical": typical}
