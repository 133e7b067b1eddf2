"""Cards that CalculiX and Abaqus share: the mesh with its sets, what is held, and the load's amplitude."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.export.quadratic import QuadraticMesh
from palpate.protocol import Protocol
from palpate.specification import Specification

REFERENCE = "REFERENCE"


@dataclass(frozen=True)
class Onset:
    """The small load that resolves the initial overlap at once, held until the history passes it.

    Attributes
    ----------
    load
        [mN], a tenth of the smallest load that counts.
    time, end
        When it is reached and when the history passes it [s].
    """

    load: float
    time: float
    end: float


def onset_of(specification: Specification) -> Onset:
    """Return the onset of a specification's load history."""
    protocol = specification.protocol
    loads = protocol.sample_load
    load = 0.1 * float(loads[loads > 0.005 * protocol.max_load][0])
    after = int(np.flatnonzero(protocol.knot_load > load)[0])
    end = np.interp(load, protocol.knot_load[after - 1 : after + 1], protocol.knot_time[after - 1 : after + 1])
    return Onset(load, 1e-6 * float(end), float(end))


def mesh_cards(mesh: QuadraticMesh) -> list[str]:
    """Return nodes, elements, surfaces, sets, the far boundary's equations, and what is held."""
    lines = [
        f"** palpate: axisymmetric indentation. Units um, mN, s, GPa. Depth = {mesh.overlap:.12g} + U2 of {REFERENCE}."
    ]
    lines += ["*NODE, NSET=NALL", *(f"{n}, {r:.12g}, {z:.12g}" for n, (r, z) in enumerate(mesh.nodes, 1))]
    number = 1
    for kind, name, elements in (
        ("CAX6", "TIP", mesh.triangles),
        ("CAX8R", "RINGS", mesh.quads),
        ("CAX8R", "INDENTER", mesh.indenter),
    ):
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for element in elements:
            lines.append(f"{number}, " + ", ".join(str(node + 1) for node in element))
            number += 1
    surface = [mesh.top_triangle + 1, *(mesh.top_quads + len(mesh.triangles) + 1)]
    behind = np.arange(len(mesh.indenter)) + len(mesh.triangles) + len(mesh.quads) + 1
    for name, faces in (("SURFACE", surface), ("FACE", behind)):
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{face}, S1" for face in faces)]
    for name, nodes in (("AXIS", mesh.axis), ("FAR", mesh.far), ("FIXED", np.unique(mesh.indenter))):
        lines += [f"*NSET, NSET={name}", *(f"{node + 1}," for node in nodes)]
    lines += [f"*NSET, NSET={REFERENCE}", f"{mesh.far[0] + 1},"]
    for node in mesh.far[1:]:
        lines += ["*EQUATION", "2", f"{node + 1}, 2, 1., {mesh.far[0] + 1}, 2, -1."]
    lines += ["*BOUNDARY", "AXIS, 1, 1", "FAR, 1, 1", "FIXED, 1, 2"]
    return lines


def amplitude_cards(protocol: Protocol, onset: Onset) -> list[str]:
    """Return the load history as an amplitude of the total time."""
    later = protocol.knot_time > onset.end
    times = np.concatenate([[0.0, onset.time, onset.end], protocol.knot_time[later]])
    loads = np.concatenate([[0.0, onset.load, onset.load], protocol.knot_load[later]])
    lines = ["*AMPLITUDE, NAME=LOAD, TIME=TOTAL TIME"]
    return [*lines, *(f"{t:.12g}, {p:.12g}" for t, p in zip(times, loads, strict=True))]
