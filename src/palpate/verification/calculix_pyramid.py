"""The elastic pyramid in CalculiX: its own elements, contact and mirror planes on a wedge of the same size."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from palpate.analytic import berkovich
from palpate.errors import PalpateError
from palpate.export.wedge import deck
from palpate.fem.indent import mesh_radii
from palpate.fem.mesh import Resolution
from palpate.fem3d.mesh import wedge_mesh
from palpate.fem3d.newton import SIXTH
from palpate.fem3d.shell import shell
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.protocol import Protocol
from palpate.specification import Specification
from palpate.specimen import Specimen
from palpate.verification.calculix import printed
from palpate.verification.case import Case, Outcome, Row, Settings, depth
from palpate.verification.materials import HOOKE
from palpate.verification.pyramid import PYRAMID

PRINTED = re.compile(r"time\s+(\S+)\s+\S+\s+\S+\s+(\S+)")
LATER = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([0.5, 1.0]))
COUNTS_FROM = 0.7  # of the way: before that the contact lies on few of its elements
MESH = Resolution(growth=1.12, sectors=9)
WITHIN = {"standard": 0.008, "medium": 0.006}
REACH = 9.0  # of the depth: the contact ends at 3.5 of it, under the edges


def depth_at_one(
    program: Path, indenter: Indenter, law: dict[str, float], guess: float, resolution: Resolution
) -> tuple[float, float]:
    """Return the depth [nm] under 1 mN and how far the values of single increments lie apart, relatively.

    The indenter is moved to a `guess` [nm]; depth grows as the root of the load.

    Raises
    ------
    PalpateError
        When CalculiX does not get there.
    """
    specimen, depth = Specimen(LAWS["elastic"].coefficients(law)), 1e-3 * guess
    mesh = wedge_mesh(mesh_radii(specimen, indenter, LATER, resolution), shell(resolution.sectors))
    found = PRINTED.findall(printed(program, deck(mesh, REACH * depth, indenter.face_slope, depth, **law)))
    part, force = np.array([[float(number) for number in row] for row in found]).reshape(-1, 2).T
    counts = part >= COUNTS_FROM
    if not np.any(part >= 1.0):
        raise PalpateError("CalculiX did not reach the depth under the pyramid")
    values = guess * part[counts] / np.sqrt(-SIXTH * force[counts])
    return float(values.mean()), float(np.ptp(values) / values.mean())


def run(settings: Settings) -> Outcome:
    """Compare the depth under 1 mN, or say why there is nothing to compare."""
    if settings.calculix is None:
        return Outcome([], notes=["CalculiX (ccx) was not run: it is not on the PATH, or a quick run was asked for."])
    theirs, scatter = depth_at_one(settings.calculix, PYRAMID, HOOKE, float(berkovich.depth(1.0, **HOOKE)), MESH)
    note = f"single increments of CalculiX' differ by {100 * scatter:.1f} %"
    rows = []
    for accuracy, allowed in WITHIN.items():
        found = depth(Specification("elastic", HOOKE, PYRAMID, LATER, accuracy=accuracy))[-1]
        rows.append(Row(f"pyramid, elastic: depth, {accuracy} [nm]", theirs, float(found), allowed, note))
    return Outcome(rows)


CASE = Case("calculix_pyramid", "Berkovich pyramid: CalculiX", run)
