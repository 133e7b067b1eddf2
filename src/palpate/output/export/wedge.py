"""A deck for CalculiX: an elastic wedge, one sixth of a body, pressed by one face of a rigid pyramid.

The wedge has the nodes of `palpate.solver.pyramid.mesh_3d` but CalculiX' own elements (C3D8I: incompatible modes),
contact (penalty, surface to surface), friction and mirror planes. The indenter is one stiff element whose lowest face
lies on the pyramid's; it is moved, so that the load is a reaction.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from palpate.output.export.cards import friction_cards
from palpate.solver.pyramid.mesh_3d import Mesh3D
from palpate.solver.pyramid.shell import WEDGE

INCREMENTS = 8  # of a deck, unless it asks for others
PENETRATION = 2e-4  # of the depth, under a pressure of a fifth of Young's modulus
FACES = {1: (0, 1, 2, 3), 2: (4, 7, 6, 5), 3: (0, 4, 5, 1), 4: (1, 5, 6, 2), 5: (2, 6, 7, 3), 6: (3, 7, 4, 0)}


def deck(
    mesh: Mesh3D,
    reach: float,
    slope: float,
    depth: float,
    youngs_modulus: float,
    poisson_ratio: float,
    friction: float = 0.0,
    increments: int = INCREMENTS,
) -> str:
    """Return the text of the deck, which prints the reaction along z of the wedge [mN] after each of its increments.

    Parameters
    ----------
    mesh : Mesh3D
        Of the wedge, in um.
    reach, depth
        Distance from the axis up to which the surface may touch, and how far the indenter moves [um].
    slope
        Of the pyramid's face along its middle.
    youngs_modulus, poisson_ratio
        [GPa], [-]
    friction
        Coulomb coefficient; before the limit a force moves the surface ten times as far along the indenter as into it.
    increments
        How many equal ones the way is taken in, at least.
    """
    body, tip = len(mesh.elements), len(mesh.nodes) + np.arange(1, 9)
    degenerate = (mesh.elements[:, 0] == mesh.elements[:, 1]).sum()
    corners = reach * np.array([(-2, -2), (2, -2), (2, 3), (-2, 3)])
    indenter = [(x, y, z) for z in (None, 3 * reach) for x, y in corners]
    nodes = [*mesh.nodes, *((x, y, slope * x if z is None else z) for x, y, z in indenter)]
    elements = mesh.elements + 1
    stiffness = 0.2 * youngs_modulus / (PENETRATION * depth)
    return "\n".join(
        [
            "** palpate: one sixth of a Berkovich indentation. Units um, mN, GPa.",
            "*NODE, NSET=NALL",
            *(f"{n}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(nodes, 1)),
            "*ELEMENT, TYPE=C3D8, ELSET=CORE",
            *_numbered(elements[:degenerate], 1),
            "*ELEMENT, TYPE=C3D8I, ELSET=BODY",
            *_numbered(elements[degenerate:], degenerate + 1),
            "*ELEMENT, TYPE=C3D8, ELSET=INDENTER",
            *_numbered(tip[None], body + 1),
            "*SURFACE, NAME=SURFACE, TYPE=ELEMENT",
            *_surface(mesh, reach),
            "*SURFACE, NAME=FACE, TYPE=ELEMENT",
            f"{body + 1}, S1",
            *_material("BODY", ("CORE", "BODY"), youngs_modulus, poisson_ratio),
            *_material("INDENTER", ("INDENTER",), 1e3 * youngs_modulus, 0.3),
            "*SURFACE INTERACTION, NAME=CONTACT",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            f"{stiffness:.6g}",
            *friction_cards(friction, stiffness),
            "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE",
            "SURFACE, FACE",
            *_held(mesh),
            *_set("TIP", tip),
            "*BOUNDARY",
            "TIP, 1, 2",
            "*STEP, INC=500",
            "*STATIC",
            f"{1 / increments}, 1., 1e-4, {1 / increments}",
            "*BOUNDARY",
            f"TIP, 3, 3, {-depth:.12g}",
            "*NODE PRINT, NSET=TIP, TOTALS=ONLY",
            "RF",
            "*END STEP",
            "",
        ]
    )


def _numbered(elements: np.ndarray, first: int) -> Iterable[str]:
    return (f"{number}, " + ", ".join(map(str, element)) for number, element in enumerate(elements, first))


def _set(name: str, nodes: np.ndarray) -> list[str]:
    return [f"*NSET, NSET={name}", *(f"{node}," for node in nodes)]


def _material(name: str, sets: Iterable[str], youngs_modulus: float, poisson_ratio: float) -> list[str]:
    sections = [f"*SOLID SECTION, ELSET={one}, MATERIAL={name}" for one in sets]
    return [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{youngs_modulus:.12g}, {poisson_ratio:.12g}", *sections]


def _surface(mesh: Mesh3D, reach: float) -> Iterable[str]:
    top = np.isin(np.arange(len(mesh.nodes)), mesh.surface)
    for number, element in enumerate(mesh.elements, 1):
        if np.linalg.norm(mesh.nodes[element], axis=1).max() < reach:
            for face, corners in FACES.items():
                touched = element[list(corners)]
                if top[touched].all() and len(set(touched)) > 2:
                    yield f"{number}, S{face}"


def _held(mesh: Mesh3D) -> list[str]:
    """Return what the mirror planes and the far boundary hold, along axes turned where the mesh turns them."""
    fixed, numbers = mesh.equations < 0, np.arange(1, len(mesh.nodes) + 1)
    turned, far = mesh.turn[:, 1] > 0, fixed.all(axis=1)
    axis = fixed[:, :2].all(axis=1) & ~far
    planes = fixed[:, 1] & ~axis & ~far
    cos, sin = np.cos(WEDGE), np.sin(WEDGE)
    return [
        *_set("FAR", numbers[far]),
        *_set("AXIS", numbers[axis]),
        *_set("FACE_PLANE", numbers[planes & ~turned]),
        *_set("EDGE_PLANE", numbers[planes & turned]),
        "*TRANSFORM, NSET=EDGE_PLANE, TYPE=R",
        f"{cos:.15g}, {sin:.15g}, 0., {-sin:.15g}, {cos:.15g}, 0.",
        "*BOUNDARY",
        "FAR, 1, 3",
        "AXIS, 1, 2",
        "FACE_PLANE, 2, 2",
        "EDGE_PLANE, 2, 2",
    ]
