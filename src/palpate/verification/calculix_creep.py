"""Steady creep at small strains in CalculiX, without and with friction, on two meshes and in two time steps.

CalculiX' creep is first order in the time step, so its curve is extrapolated from two.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

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
from palpate.verification.case import Outcome, Plot, Row, Settings, Verification
from palpate.verification.reference_materials import STEADY_CREEP

CREEP = Comparison("steady creep", "nonlinear_burgers", STEADY_CREEP, 1.0, 30.0)
POINTS = 25  # of a test, then twice as many for its own error


def extrapolated(program: Path, friction: float) -> tuple[np.ndarray, float]:
    """Return the depth (n,) [nm] on the fine mesh at no time step, and its refinement error in mesh and step."""
    tests = [CREEP.specification(points, friction=friction) for points in (POINTS, 2 * POINTS)]
    long, short = (run_deck(program, test, RESOLUTIONS["standard"]) for test in tests)
    fine = run_deck(program, tests[0], RESOLUTIONS["fine"])
    return refined(tests[0], long, short[1::2], fine)


def compare(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare creep under a cone with this friction."""
    theirs, own_error = extrapolated(program, friction)
    return compared(CREEP.titled(friction), CREEP.specification(POINTS, friction=friction), theirs, own_error)


def run(settings: Settings) -> Outcome:
    """Compare both, or say why there is nothing to compare."""
    return with_and_without_friction(settings, compare, [RULE, STEPS])


CASE = Verification("calculix_creep", "CalculiX: steady creep", run)
