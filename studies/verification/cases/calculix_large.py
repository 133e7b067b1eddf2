"""Aluminium at large strains in CalculiX, without and with friction, on two meshes and in two steps of the motion.

CalculiX moves the body onto the indenter and returns the load; palpate is given that load, and the depths are compared.
Steps grow with the depth: in a step that doubles the contact the plastic flow would have one direction.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from palpate.errors import PalpateError
from palpate.output.export.calculix_moved import SHEARED, deck
from palpate.output.export.quadratic import quadratic_mesh
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.verification.calculix import (
    PRINTED,
    RULE,
    STEPS,
    compared,
    printed,
    refined,
    table,
    with_and_without_friction,
)
from studies.verification.case import Plot, Row
from studies.verification.reference_materials import ALUMINIUM, CONE

FORCE = re.compile(r"FIXED and time\s+\S+\s+\S+\s+(\S+)\s+\S+")
WEDGES = 180  # CalculiX takes a body of revolution for a wedge of two degrees
KNOTS = 620.0 * np.array([0.0, 0.2, 0.45, 1.0, 0.975])  # nm; back until about a tenth of the load is left
POINTS = 20  # from one of them to the next; with fewer CalculiX loses its way on the coarse mesh with friction
LEAST = 0.05  # of the largest load, below which its depth does not count


@dataclass(frozen=True, eq=False)
class Curve:
    """What CalculiX found: time [s], depth [nm] and load [mN], each of shape (n,), up to the last counted sample."""

    time: np.ndarray
    depth: np.ndarray
    load: np.ndarray

    @property
    def protocol(self) -> Protocol:
        """The load history, sampled where it has its corners."""
        return Protocol(np.append(0.0, self.time), np.append(0.0, self.load), self.time)

    def depth_under(self, load: np.ndarray) -> np.ndarray:
        """Return the depth [nm] under the loads (n,) of another curve: to the peak, then back.

        Brought to that curve's largest load by the law of a sharp tip, by which depths go with the root of the load.
        """
        ratio, peak, turn = load.max() / self.load.max(), int(np.argmax(self.load)), int(np.argmax(load))
        loads, depths = ratio * self.load, np.sqrt(ratio) * self.depth
        up = np.interp(load[: turn + 1], loads[: peak + 1], depths[: peak + 1])
        down = np.interp(load[turn + 1 :], loads[peak:][::-1], depths[peak:][::-1])
        return np.concatenate([up, down])


def specification(protocol: Protocol, friction: float) -> Specification:
    """Return the test of a load history."""
    indenter = replace(CONE, friction=friction)
    return Specification("bilinear_plasticity", ALUMINIUM, indenter, protocol, kinematics="large", accuracy="fine")


def moved(program: Path, friction: float, points: int, resolution: Resolution) -> Curve:
    """Run CalculiX with so many samples from knot to knot; raises `PalpateError` when it stops before it turns back.

    Parameters
    ----------
    program
        CalculiX.
    friction
        Coulomb coefficient.
    points
        Number of samples from knot to knot.
    resolution
        Of the mesh.
    """
    ends = np.arange(float(len(KNOTS)))
    times = np.arange(1, points * (len(KNOTS) - 1) + 1) / points
    asked = specification(Protocol(ends, 4.9 * (KNOTS / KNOTS.max()) ** 2, times), friction)
    mesh = quadratic_mesh(asked, resolution)
    text = printed(program, deck(asked, KNOTS, mesh))
    time, rise = table(PRINTED, text).T
    if time[-1] < ends[-2]:
        raise PalpateError(f"CalculiX stopped at {1e3 * (mesh.overlap + rise[-1]):.0f} of {KNOTS.max():g} nm")
    load = -WEDGES * table(FORCE, text)[:, 0]
    bears = np.logical_and.accumulate((load >= LEAST * load.max()) | (time <= time[np.argmax(load)]))
    return Curve(time[bears], 1e3 * (mesh.overlap + rise[bears]), load[bears])


def compare(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare aluminium under a cone with this friction."""
    long, short, fine = (
        moved(program, friction, points, SHEARED[mesh])
        for points, mesh in ((POINTS, "standard"), (2 * POINTS, "standard"), (POINTS, "fine"))
    )
    test = specification(fine.protocol, friction)
    in_long, in_short = (curve.depth_under(fine.load) for curve in (long, short))
    theirs = refined(test, in_long, in_short, fine.depth, ripples=True)
    return compared("aluminium, large strains", test, *theirs)


CASES = (with_and_without_friction("calculix_large", "CalculiX: aluminium at large strains", compare, [RULE, STEPS]),)
