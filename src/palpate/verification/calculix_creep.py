"""Steady creep at small strains in CalculiX, without and with friction, on two meshes and in two time steps.

CalculiX' creep is first order in the time step, so its curve is extrapolated from two.
"""

from __future__ import annotations

from pathlib import Path

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.verification.calculix import (
    RULE,
    STEPS,
    Comparison,
    compared,
    refined,
    run_deck,
    with_and_without_friction,
)
from palpate.verification.case import Plot, Row
from palpate.verification.reference_materials import STEADY_CREEP

CREEP = Comparison("steady creep", "nonlinear_burgers", STEADY_CREEP, 1.0, 30.0)
POINTS = 25  # of a test, then twice as many for its own error


def compare(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare creep under a cone with this friction."""
    test, halved = (CREEP.specification(points, friction=friction) for points in (POINTS, 2 * POINTS))
    long, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
    short = run_deck(program, halved, RESOLUTIONS["standard"])[1::2]
    return compared(CREEP.name, test, *refined(test, long, short, fine))


CASE = with_and_without_friction("calculix_creep", "CalculiX: steady creep", compare, [RULE, STEPS])
