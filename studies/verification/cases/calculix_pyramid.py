"""The elastic pyramid in CalculiX: its own elements, contact, friction, mirror planes, on a wedge of the same size."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.analytic import berkovich
from palpate.errors import PalpateError
from palpate.materials import LAWS
from palpate.output.export.wedge import INCREMENTS, deck
from palpate.solver.axisymmetric.discretisation import mesh_radii
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.mesh_3d import wedge_mesh
from palpate.solver.pyramid.problem_3d import WEDGES
from palpate.solver.pyramid.shell import shell
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from palpate.study.specimen import Specimen
from studies.verification.calculix import NOT_RUN, printed
from studies.verification.case import Outcome, Row, Settings, Verification, depth
from studies.verification.cases.pyramid_checks import PYRAMID
from studies.verification.reference_materials import HOOKE

PRINTED = re.compile(r"time\s+(\S+)\s+\S+\s+\S+\s+(\S+)")
LATER = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([0.5, 1.0]))
COUNTS_FROM = 0.7  # of the way: before that the contact lies on few of its elements
MESH = Resolution(growth=1.12, sectors=9)
WITHIN = {"standard": 0.008, "medium": 0.006}  # of the depth, by accuracy
FRICTION = 0.25
ROUGH_MESH = Resolution(growth=1.2, sectors=6, far=100.0)  # friction takes CalculiX many more iterations
ROUGH_INCREMENTS = 16  # what slips in an increment counts from its start, before a new node has touched
ROUGH_WITHIN = 0.002  # of the depth
SMOOTHLY = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.linspace(1 / 16, 1.0, 16) ** 2)
REACH = 9.0  # of the depth: the contact ends at 3.5 of it, under the edges


def depth_at_one(
    program: Path,
    indenter: Indenter,
    law: dict[str, float],
    guess: float,
    resolution: Resolution,
    increments: int = INCREMENTS,
) -> tuple[float, float]:
    """Return the depth [nm] under 1 mN and how far the values of single increments lie apart, relatively.

    The indenter is moved to a `guess` [nm]; depth grows as the root of the load.

    Parameters
    ----------
    program
        CalculiX.
    indenter
        The pyramid.
    law
        Parameters of the elastic law.
    guess
        Depth to which the indenter is moved [nm].
    resolution
        Of the mesh.
    increments
        Number of increments.

    Raises
    ------
    PalpateError
        When CalculiX does not get there.
    """
    specimen, depth = Specimen(LAWS["elastic"].coefficients(law)), 1e-3 * guess
    mesh = wedge_mesh(mesh_radii(specimen, indenter, LATER, resolution), shell(resolution.sectors))
    text = deck(
        mesh, REACH * depth, indenter.face_slope, depth, **law, friction=indenter.friction, increments=increments
    )
    found = PRINTED.findall(printed(program, text))
    part, force = np.array([[float(number) for number in row] for row in found]).reshape(-1, 2).T
    counts = part >= COUNTS_FROM
    if not np.any(part >= 1.0):
        raise PalpateError("CalculiX did not reach the depth under the pyramid")
    values = guess * part[counts] / np.sqrt(-WEDGES * force[counts])
    return float(values.mean()), float(np.ptp(values) / values.mean())


def run(settings: Settings) -> Outcome:
    """Compare the depth under 1 mN, or say why there is nothing to compare."""
    if settings.calculix is None:
        return Outcome([], notes=[NOT_RUN])
    guess = float(berkovich.depth(1.0, **HOOKE))
    theirs, scatter = depth_at_one(settings.calculix, PYRAMID, HOOKE, guess, MESH)
    note = f"single increments of CalculiX' differ by {100 * scatter:.1f} %"
    rows = []
    for accuracy, allowed in WITHIN.items():
        found = depth(Specification("elastic", HOOKE, PYRAMID, LATER, accuracy=accuracy, kinematics="small"))[-1]
        rows.append(Row(f"pyramid, elastic: depth, {accuracy} [nm]", theirs, float(found), allowed, note))
    rows.append(_held_back(settings.calculix, guess))
    return Outcome(rows)


def _held_back(program: Path, guess: float) -> Row:
    """Compare what friction does to the depth; errors that both runs of a program share drop out."""
    tips = PYRAMID, replace(PYRAMID, friction=FRICTION)
    smooth, rough = (depth_at_one(program, tip, HOOKE, guess, ROUGH_MESH, ROUGH_INCREMENTS)[0] for tip in tips)
    curves = [depth(Specification("elastic", HOOKE, tip, SMOOTHLY, kinematics="small")) for tip in tips]
    later = SMOOTHLY.sample_load >= COUNTS_FROM**2
    return Row(
        f"pyramid, elastic: depth with friction {FRICTION:g} over that without, standard",
        rough / smooth,
        float(np.mean((curves[1] / curves[0])[later])),
        ROUGH_WITHIN,
        "both of CalculiX' curves on a coarser mesh",
    )


CASES = (Verification("calculix_pyramid", "Berkovich pyramid: CalculiX", run),)
