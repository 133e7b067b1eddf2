"""Aluminium at small strains in CalculiX, without and with friction, on two meshes and in two steps of the load.

The direction of plastic flow is that at the end of a step, and the contact that spreads turns it meanwhile: steps grow
with the load.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from palpate.verification.calculix import RULE, STEPS, compared, refined, run_deck, with_and_without_friction
from palpate.verification.case import Plot, Row
from palpate.verification.reference_materials import ALUMINIUM, CONE

KNOTS = 4.9 * np.array([0.0, 0.04, 0.1, 0.25, 0.5, 1.0, 0.05])  # mN
POINTS = 6  # from one of them to the next


def specification(points: int, friction: float) -> Specification:
    """Return the test, with so many samples from knot to knot."""
    ends = np.arange(float(len(KNOTS)))
    protocol = Protocol(ends, KNOTS, np.arange(1, points * (len(KNOTS) - 1) + 1) / points)
    return Specification("bilinear_plasticity", ALUMINIUM, replace(CONE, friction=friction), protocol, accuracy="fine")


def compare(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare aluminium under a cone with this friction."""
    test, halved = (specification(points, friction) for points in (POINTS, 2 * POINTS))
    long, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
    short = run_deck(program, halved, RESOLUTIONS["standard"])[1::2]
    return compared("aluminium, small strains", test, *refined(test, long, short, fine, ripples=True))


CASE = with_and_without_friction("calculix_plastic", "CalculiX: aluminium at small strains", compare, [RULE, STEPS])
