"""Indentations that are the same but for their size are simulated once.

A sharp tip and a body without a length of its own know no size but that of the contact. Under histories whose loads are
in proportion at all times, depths go with the root of the load: depth / sqrt(load) cannot depend on the largest load
(Y.-T. Cheng and C.-M. Cheng, Mater. Sci. Eng. R 44 (2004) 91-149, section 3). Under given displacements loads go with
their square, where the transducer's compliance falls with them. The mesh grows with the contact, so that
this holds for the simulated curves as it does for the exact ones.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from palpate.fem.batch import Case, indent_batch
from palpate.fem.history import History
from palpate.protocol import LOAD

CLOSE = 1e-12


def indent_distinct(cases: Sequence[Case]) -> list[History]:
    """Simulate all cases; those that differ in size alone once, and share the solver's wall time evenly."""
    distinct: list[Case] = []
    places = []
    for case in cases:
        ratios = (length_ratio(case, earlier) for earlier in distinct)
        place, ratio = next(((k, ratio) for k, ratio in enumerate(ratios) if ratio), (len(distinct), 1.0))
        if place == len(distinct):
            distinct.append(case)
        places.append((place, ratio))
    shared = Counter(place for place, _ in places)
    histories = [replace(h, seconds=h.seconds / shared[k]) for k, h in enumerate(indent_batch(distinct))]
    return [
        replace(histories[k], depth=ratio * histories[k].depth, load=ratio**2 * histories[k].load)
        for k, ratio in places
    ]


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
        return math.sqrt(share)
    return share if math.isclose(one.compliance * share, two.compliance, rel_tol=CLOSE) else None


def _without_length(case: Case) -> bool:
    body = case.specimen
    return case.indenter.sharp and not (body.size_length or body.adhesion) and math.isinf(body.film_thickness)


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
