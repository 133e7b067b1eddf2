"""Elasticity, steady creep and plasticity at small strains in CalculiX, without and with friction, on two meshes.

CalculiX' creep and plasticity are first order in the time step, so their curves are extrapolated from two. The
direction of plastic flow is that at the end of a step, and the contact that spreads turns it meanwhile: its steps grow
with the load. Unloading ends at 5 % of the load, before contact is lost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.verification.calculix import (
    RULE,
    STEPS,
    compared,
    refined,
    refinement_error,
    run_deck,
    with_and_without_friction,
)
from studies.verification.case import Plot, Row
from studies.verification.reference_materials import ALUMINIUM, CONE, HOOKE, STEADY_CREEP

CREEP_POINTS = 25  # samples in loading, and as many in unloading; then twice as many for the error of the step
PLASTIC_KNOTS = 4.9 * np.array([0.0, 0.04, 0.1, 0.25, 0.5, 1.0, 0.05])  # mN
PLASTIC_POINTS = 6  # from one of them to the next


def under_cone(law: str, values: Mapping[str, float], friction: float, protocol: Protocol) -> Specification:
    """Return the test of a law with some `values`, under the cone with this `friction` and a `protocol`."""
    return Specification(law, values, replace(CONE, friction=friction), protocol, accuracy="fine", kinematics="small")


def ramps(duration: float, points: int) -> Protocol:
    """Return loading to 1 mN and unloading, each of this duration [s] at most and sampled at so many points."""
    up, down = np.linspace(0.0, duration, points + 1), duration * np.linspace(1.0, 1.95, points + 1)
    knots = duration * np.array([0.0, 1.0, 1.95])
    return Protocol(knots, np.array([0.0, 1.0, 0.05]), np.concatenate([up[1:], down[1:]]))


def elastic(points: int, friction: float = 0.0) -> Specification:
    """Return the test of an elastic body."""
    return under_cone("elastic", HOOKE, friction, ramps(1.0, points))


def creeping(points: int, friction: float) -> Specification:
    """Return the test of a creeping body."""
    return under_cone("nonlinear_burgers", STEADY_CREEP, friction, ramps(30.0, points))


def yielding(points: int, friction: float) -> Specification:
    """Return the test of a body that yields, with so many samples from knot to knot."""
    count = len(PLASTIC_KNOTS)
    times = np.arange(1, points * (count - 1) + 1) / points
    protocol = Protocol(np.arange(float(count)), PLASTIC_KNOTS, times)
    return under_cone("bilinear_plasticity", ALUMINIUM, friction, protocol)


def compare_elastic(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare elasticity under a cone with this friction."""
    test = elastic(20, friction)
    coarse, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
    return compared("elastic", test, fine, refinement_error(test, fine, coarse))


def compare_creep(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare steady creep under a cone with this friction."""
    test, halved = (creeping(n * CREEP_POINTS, friction) for n in (1, 2))
    return compared("steady creep", *_extrapolated(program, test, halved))


def compare_plastic(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare aluminium under a cone with this friction."""
    test, halved = (yielding(n * PLASTIC_POINTS, friction) for n in (1, 2))
    return compared("aluminium, small strains", *_extrapolated(program, test, halved, ripples=True))


def _extrapolated(
    program: Path, test: Specification, halved: Specification, ripples: bool = False
) -> tuple[Specification, np.ndarray, float]:
    """Return a test, CalculiX' depth extrapolated from its steps and `halved` ones, and the refinement error."""
    long, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
    short = run_deck(program, halved, RESOLUTIONS["standard"])[1::2]
    return test, *refined(test, long, short, fine, ripples)


CASES = (
    with_and_without_friction("calculix_elastic", "CalculiX: elasticity", compare_elastic, [RULE]),
    with_and_without_friction("calculix_creep", "CalculiX: steady creep", compare_creep, [RULE, STEPS]),
    with_and_without_friction(
        "calculix_plastic", "CalculiX: aluminium at small strains", compare_plastic, [RULE, STEPS]
    ),
)
