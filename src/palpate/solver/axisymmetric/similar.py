"""Indentations that are the same but for their size are simulated once.

A sharp tip and a body without a length of its own know no size but that of the contact. Under histories whose loads are
in proportion at all times, depths go with the root of the load: depth / sqrt(load) cannot depend on the largest load
(Y.-T. Cheng and C.-M. Cheng, Mater. Sci. Eng. R 44 (2004) 91-149, section 3). Under given displacements loads go with
their square, where the transducer's compliance falls with them; under given loads a spring stiffens
with them. The mesh grows with the contact, so that this holds for the simulated curves as it does for the exact ones;
where its rings are given, it does not grow.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from palpate.base.classes import classes_of
from palpate.solver.axisymmetric.history import History
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.study.protocol import LOAD

CLOSE = 1e-12  # relative, within which histories are in proportion


def indent_distinct(cases: Sequence[Case], perturbed: Sequence[Sequence[Case]] = ()) -> list[History]:
    """Simulate all cases; those that differ in size alone once, and share the solver's wall time evenly.

    Parameters
    ----------
    perturbed
        Neighbours of each case, see `palpate.solver.axisymmetric.march_cases.indent_batch`; those of cases that are
        simulated once must differ as they do.
    """
    rows = perturbed or [()] * len(cases)
    distinct: list[int] = []
    places = []
    for number, case in enumerate(cases):
        ratios = (_ratio_of_all([case, *rows[number]], [cases[k], *rows[k]]) for k in distinct)
        place, ratio = next(((k, ratio) for k, ratio in enumerate(ratios) if ratio), (len(distinct), 1.0))
        if place == len(distinct):
            distinct.append(number)
        places.append((place, ratio))
    shared = Counter(place for place, _ in places)
    ran = indent_batch([cases[k] for k in distinct], [rows[k] for k in distinct] if perturbed else ())
    histories = [replace(h, seconds=h.seconds / shared[k]) for k, h in enumerate(ran)]
    return [_enlarged(histories[k], ratio) for k, ratio in places]


def free_lanes(cases: Sequence[Case]) -> int:
    """Return how many times all cases, each a little changed, fit into the lanes that they take once."""
    kinds = Counter(members[0].kind for members in classes_of(cases, length_ratio))
    return max(1, LANES // max(kinds.values()))


def _ratio_of_all(row: Sequence[Case], others: Sequence[Case]) -> float | None:
    """Return the ratio of lengths that all cases of a row have to those of another; ``None`` where there is none."""
    if len(row) != len(others) or (first := length_ratio(row[0], others[0])) is None:
        return None
    for case, other in zip(row[1:], others[1:], strict=True):
        ratio = length_ratio(case, other)
        if ratio is None or not math.isclose(ratio, first, rel_tol=CLOSE):
            return None
    return first


def _enlarged(history: History, ratio: float) -> History:
    """Return a history with all lengths in a ratio."""
    return replace(
        history,
        depth=ratio * history.depth,
        load=ratio**2 * history.load,
        perturbed_depths=ratio * history.perturbed_depths,
        perturbed_loads=ratio**2 * history.perturbed_loads,
    )


def length_ratio(case: Case, other: Case) -> float | None:
    """Return all lengths of one case over those of another that is the same but for its size; ``None`` otherwise."""
    if not (_without_length(case) and _without_length(other) and _alike(case, other)):
        return None
    one, two = case.protocol, other.protocol
    drive, others = one.knot_drive, two.knot_drive
    share = drive.max() / others.max()
    if not np.allclose(drive, share * others, rtol=CLOSE, atol=CLOSE * drive.max()):
        return None
    if one.control == LOAD:
        ratio = math.sqrt(share)
        return ratio if math.isclose(one.spring, ratio * two.spring, rel_tol=CLOSE) else None
    return share if math.isclose(one.compliance * share, two.compliance, rel_tol=CLOSE) else None


def _without_length(case: Case) -> bool:
    body, free = case.specimen, case.rings is None
    return free and case.indenter.sharp and not (body.size_length or body.adhesion) and body.is_uniform


def _alike(case: Case, other: Case) -> bool:
    """Return whether two cases have the same material, tip, mesh and times."""
    first, second = case.protocol, other.protocol
    return (
        (case.indenter, case.resolution, case.large, case.shift)
        == (other.indenter, other.resolution, other.large, other.shift)
        and np.array_equal(case.specimen.coefficients, other.specimen.coefficients)
        and first.control == second.control
        and np.array_equal(first.knot_time, second.knot_time)
        and np.array_equal(first.sample_time, second.sample_time)
    )
