"""Curves from CalculiX, an independent program: runs the deck that `palpate export` writes, and reads its depths.

Each comparison uses two CalculiX runs that differ in mesh or time step; their difference tells its own error. Its creep
is first order in the time step, so the steady-creep curve is extrapolated from two steps.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.errors import PalpateError
from palpate.export.calculix import deck
from palpate.export.quadratic import RESOLUTIONS, quadratic_mesh
from palpate.fem.mesh import Resolution
from palpate.protocol import Protocol
from palpate.specification import Specification
from palpate.verification.case import Case, Outcome, Plot, Row, Series, Settings, depth, rms, worst
from palpate.verification.materials import ALUMINIUM, CONE, HOOKE, STEADY_CREEP

TIME_LIMIT = 600.0
ELASTIC_WITHIN, CREEP_WITHIN, PLASTIC_WITHIN = 0.008, 0.008, 0.02
PRINTED = re.compile(r"time\s+(\S+)\s+\d+\s+\S+\s+(\S+)\s+\S+")


def printed(program: Path, text: str) -> str:
    """Run CalculiX on one core with a deck and return what it prints to its .dat file, if anything.

    Raises
    ------
    PalpateError
        When it takes longer than ten minutes.
    """
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "deck.inp").write_text(text, encoding="ascii")
        environment = os.environ | {"OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1"}
        try:
            subprocess.run(
                [program, "deck"], cwd=folder, env=environment, capture_output=True, timeout=TIME_LIMIT, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise PalpateError(f"CalculiX took longer than {TIME_LIMIT:g} s") from error
        output = Path(folder, "deck.dat")
        return output.read_text() if output.exists() else ""


def run_deck(program: Path, specification: Specification, resolution: Resolution) -> np.ndarray:
    """Run CalculiX and return the depth [nm] at the samples, NaN after the time that it reached.

    Raises
    ------
    PalpateError
        When it stops without any result, or takes longer than ten minutes.
    """
    overlap = quadratic_mesh(specification, resolution).overlap
    found = PRINTED.findall(printed(program, deck(specification, resolution)))
    if not found:
        raise PalpateError("CalculiX wrote no depths")
    time, rise = np.array([[float(number) for number in row] for row in found]).T
    wanted = specification.protocol.sample_time
    depths = 1e3 * (overlap + np.interp(wanted, time, rise))
    return np.where(wanted <= time[-1] * (1 + 1e-9), depths, np.nan)


@dataclass(frozen=True)
class Comparison:
    """One test for both programs; unloading ends at 5 % of the load, before contact is lost."""

    name: str
    law: str
    values: dict[str, float]
    load: float
    duration: float

    def specification(self, points: int, accuracy: str = "fine") -> Specification:
        """Return the test with `points` samples in loading and as many in unloading."""
        up = np.linspace(0.0, self.duration, points + 1)
        down = self.duration * np.linspace(1.0, 1.95, points + 1)
        knots = self.duration * np.array([0.0, 1.0, 1.95])
        protocol = Protocol(knots, self.load * np.array([0.0, 1.0, 0.05]), np.concatenate([up[1:], down[1:]]))
        return Specification(self.law, self.values, CONE, protocol, accuracy=accuracy)


ELASTIC = Comparison("elastic", "elastic", HOOKE, 1.0, 1.0)
CREEP = Comparison("steady creep", "nonlinear_burgers", STEADY_CREEP, 1.0, 30.0)
PLASTIC = Comparison("bilinear plasticity", "bilinear_plasticity", ALUMINIUM, 4.9, 15.0)


def run(settings: Settings) -> Outcome:
    """Compare from 15 % of the load on, or say why there is nothing to compare."""
    program = settings.calculix
    if program is None:
        return Outcome([], notes=["CalculiX (ccx) was not run: it is not on the PATH, or a quick run was asked for."])
    rows: list[Row] = []
    plots = []
    meshes = RESOLUTIONS["standard"], RESOLUTIONS["fine"]
    coarse, fine = (run_deck(program, ELASTIC.specification(20), mesh) for mesh in meshes)
    plots.append(_compare(ELASTIC, ELASTIC.specification(20), fine, coarse, ELASTIC_WITHIN, worst, rows))
    long, short = (run_deck(program, CREEP.specification(points), meshes[0]) for points in (25, 50))
    shared = short[1::2]
    plots.append(_compare(CREEP, CREEP.specification(25), 2 * shared - long, shared, CREEP_WITHIN, worst, rows))
    coarse, fine = (run_deck(program, PLASTIC.specification(40), mesh) for mesh in meshes)
    plots.append(_compare(PLASTIC, PLASTIC.specification(40), fine, coarse, PLASTIC_WITHIN, rms, rows))
    notes = [
        "Compared from 15 % of the load on; before that the contact lies on few of CalculiX' elements.",
        "Allowed is the sum of what both programs state: 0.4 % each for elasticity and creep, 1 % each for plasticity.",
    ]
    return Outcome(rows, plots, notes)


def _compare(comparison, specification, found_there, other, allowed, measure, rows) -> Plot:
    """Append the rows of one comparison and return its plot."""
    found, load = depth(specification), specification.protocol.sample_load
    counts = (load >= 0.15 * comparison.load) & np.isfinite(found_there)
    own_error = float(np.abs(other[counts] / found_there[counts] - 1).max())
    name = "root mean square" if measure is rms else "worst sample"
    note = f"CalculiX' two runs differ by {100 * own_error:.2f} % at most"
    rows.append(measure(f"{comparison.name}: depth, {name} [nm]", found_there[counts], found[counts], allowed, note))
    peak = int(np.argmax(load))
    rows.append(Row(f"{comparison.name}: depth at peak [nm]", float(found_there[peak]), float(found[peak]), allowed))
    deviation = 100 * (found / found_there - 1)
    reached, time = np.isfinite(found_there), specification.protocol.sample_time
    return Plot(
        f"calculix_{comparison.name.replace(' ', '_')}",
        "time [s]",
        f"depth, {comparison.name} [nm]",
        [
            Series(
                "CalculiX", specification.protocol.sample_time[reached].tolist(), found_there[reached].tolist(), True
            ),
            Series("palpate, fine", specification.protocol.sample_time.tolist(), found.tolist()),
        ],
        [Series("deviation", time[counts].tolist(), deviation[counts].tolist())],
    )


CASE = Case("calculix", "CalculiX, an independent program", run)
