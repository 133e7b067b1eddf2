"""Cards that CalculiX and Abaqus share: the mesh with its sets, what is held, and the load's amplitude."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.output.export.quadratic import QuadraticMesh
from palpate.study.protocol import Protocol

REFERENCE = "REFERENCE"
HELD = ("AXIS, 1, 1", "FAR, 1, 1", "FIXED, 1, 2")
LOADED = ("*CLOAD, AMPLITUDE=LOAD", f"{REFERENCE}, 2, 1.")
ONSET = 1e-8  # of the first segment, before which the load is zero
STICKING = 0.1  # stiffness against slip before the limit, over that against penetration; with 1 it fails to converge


def mesh_cards(mesh: QuadraticMesh, rings: str = "CAX8R") -> list[str]:
    """Return nodes, elements, surfaces, sets, the far boundary's equations, and what is held.

    Parameters
    ----------
    rings
        Type of the elements of the rings: with reduced integration, or with full (``CAX8``).
    """
    lines = [
        f"** palpate: axisymmetric indentation. Units um, mN, s, GPa. Depth = {mesh.overlap:.12g} + U2 of {REFERENCE}."
    ]
    lines += ["*NODE, NSET=NALL", *(f"{n}, {r:.12g}, {z:.12g}" for n, (r, z) in enumerate(mesh.nodes, 1))]
    number = 1
    for kind, name, elements in (
        ("CAX6", "TIP", mesh.triangles),
        (rings, "RINGS", mesh.quads),
        ("CAX8R", "INDENTER", mesh.indenter),
    ):
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for element in elements:
            lines.append(f"{number}, " + ", ".join(str(node + 1) for node in element))
            number += 1
    surface = [1, *(mesh.top_quads + len(mesh.triangles) + 1)]
    behind = np.arange(len(mesh.indenter)) + len(mesh.triangles) + len(mesh.quads) + 1
    for name, faces in (("SURFACE", surface), ("FACE", behind)):
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{face}, S1" for face in faces)]
    for name, nodes in (("AXIS", mesh.axis), ("FAR", mesh.far), ("FIXED", np.unique(mesh.indenter))):
        lines += [f"*NSET, NSET={name}", *(f"{node + 1}," for node in nodes)]
    lines += [f"*NSET, NSET={REFERENCE}", f"{mesh.far[0] + 1},"]
    for node in mesh.far[1:]:
        lines += ["*EQUATION", "2", f"{node + 1}, 2, 1., {mesh.far[0] + 1}, 2, -1."]
    return [*lines, "*BOUNDARY", *HELD]


def indenter_cards(youngs_modulus: float, interaction: Sequence[str]) -> list[str]:
    """Return the sections of body and indenter, and the contact between them with the cards of its `interaction`.

    The rigid indenter has the body's Young's modulus [GPa]: it is held at all of its nodes.
    """
    return [
        "*MATERIAL, NAME=INDENTER",
        "*ELASTIC",
        f"{youngs_modulus:.12g}, 0.3",
        "*SOLID SECTION, ELSET=TIP, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=RINGS, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=INDENTER, MATERIAL=INDENTER",
        "*SURFACE INTERACTION, NAME=CONTACT",
        *interaction,
        "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE",
        "SURFACE, FACE",
    ]


def friction_cards(coefficient: float, stiffness: float) -> list[str]:
    """Return Coulomb's law as CalculiX takes it, of a contact with a `stiffness` against penetration; none without."""
    return ["*FRICTION", f"{coefficient:.6g}, {STICKING * stiffness:.6g}"] if coefficient else []


def amplitude_cards(protocol: Protocol) -> list[str]:
    """Return the load history as an amplitude of the total time."""
    knots = zip(protocol.knot_time, protocol.knot_load, strict=True)
    return ["*AMPLITUDE, NAME=LOAD, TIME=TOTAL TIME", *(f"{time:.12g}, {load:.12g}" for time, load in knots)]


def step_cards(
    protocol: Protocol, geometry: str, procedure: str, output: Sequence[str], drive: Sequence[str] = LOADED
) -> list[str]:
    """Return the steps: an onset, then one for each segment of the load history.

    In the onset, a hundred-millionth of the first segment, the body is held while the initial overlap becomes contact.

    Parameters
    ----------
    protocol
        The load history.
    geometry
        What the first card of a step says of large strains, such as ``, NLGEOM``.
    procedure
        Card of a step's procedure; the onset is always static.
    output
        Cards that ask for the depth of the reference node.
    drive
        Cards that load the reference node, or move it.
    """
    ends = np.concatenate([[0.0, ONSET * protocol.knot_time[1]], protocol.knot_time[1:]])
    interval = float(np.max(np.diff(protocol.sample_time, prepend=0.0)))
    lines = []
    for k, duration in enumerate(np.diff(ends)):
        longest = min(1.001 * interval, duration) if k else 0.05 * duration
        lines += [
            f"*STEP{geometry}, INC={20 * len(protocol.sample_time) + 1000}",
            procedure if k else "*STATIC",
            f"{longest:.12g}, {duration:.12g}, {1e-6 * duration:.6g}, {longest:.12g}",
            "*BOUNDARY, OP=NEW",
            *HELD,
        ]
        lines += [*drive, *output] if k else [f"{REFERENCE}, 2, 2"]
        lines.append("*END STEP")
    return [*lines, ""]
