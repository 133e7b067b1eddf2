"""Aluminium at large strains in CalculiX, without and with friction, on two meshes.

CalculiX moves the body onto the indenter and tells the load; palpate is given that load, and its depth compared.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from palpate.export.calculix_moved import SHEARED, deck
from palpate.export.quadratic import quadratic_mesh
from palpate.fem.mesh import Resolution
from palpate.protocol import Protocol
from palpate.specification import Specification
from palpate.verification.calculix import FRICTION, NOT_RUN, PRINTED, RULE, compared, printed, refinement_error, table
from palpate.verification.case import Case, Outcome, Settings
from palpate.verification.materials import ALUMINIUM, CONE

FORCE = re.compile(r"FIXED and time\s+\S+\s+\S+\s+(\S+)\s+\S+")
WEDGES = 180  # CalculiX takes a body of revolution for a wedge of two degrees
DEEPEST, BACK = 620.0, 0.975  # nm; back until about a tenth of the load is left
UP, DOWN = 20, 10
LEAST = 0.05


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


def moved(program: Path, friction: float, resolution: Resolution) -> Curve:
    """Run CalculiX; raises `PalpateError` when it stops without any result."""
    times = np.concatenate([np.arange(1.0, UP + 1), UP + np.arange(1.0, DOWN + 1)])
    knots = np.array([0.0, UP, UP + DOWN])
    asked = specification(Protocol(knots, np.array([0.0, 4.9, 0.0]), times), friction)
    mesh = quadratic_mesh(asked, resolution)
    text = printed(program, deck(asked, np.array([0.0, DEEPEST, BACK * DEEPEST]), mesh))
    time, rise = table(PRINTED, text).T
    load = -WEDGES * table(FORCE, text)[:, 0]
    bears = np.logical_and.accumulate((load >= LEAST * load.max()) | (time <= time[np.argmax(load)]))
    return Curve(time[bears], 1e3 * (mesh.overlap + rise[bears]), load[bears])


def run(settings: Settings) -> Outcome:
    """Compare both, or say why there is nothing to compare."""
    if settings.calculix is None:
        return Outcome([], notes=[NOT_RUN])
    rows, plots = [], []
    for friction in (0.0, FRICTION):
        coarse, fine = (moved(settings.calculix, friction, SHEARED[mesh]) for mesh in ("standard", "fine"))
        test = specification(fine.protocol, friction)
        own_error = refinement_error(test, fine.depth, coarse.depth_under(fine.load))
        name = "aluminium, large strains" + (f", friction {friction:g}" if friction else "")
        found, plot = compared(name, test, fine.depth, own_error)
        rows += found
        plots.append(plot)
    return Outcome(rows, plots, [RULE])


CASE = Case("calculix_large", "CalculiX: aluminium at large strains", run)
