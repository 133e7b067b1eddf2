"""A folder for Abaqus/Standard: an input deck, and a user material where the law creeps.

The deck is the CalculiX one in Abaqus' terms, with its finite-sliding surface-to-surface contact. Elasticity and
bilinear plasticity are Abaqus' own laws; the nonlinear Burgers solid, with any number of Voigt elements, is the Fortran
subroutine `burgers.f` beside this module, with the same update as `palpate.materials.radial`. At large strains both
programs relate true stress to logarithmic strain; Abaqus integrates it in its corotational frame, which agrees with
`palpate.fem.hencky` only while the principal axes keep still.

Source: Abaqus Analysis User's Guide, *USER MATERIAL, *CONTACT PAIR; Abaqus User Subroutines Reference Guide, UMAT.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.export.calculix import material_cards
from palpate.export.cards import REFERENCE, amplitude_cards, mesh_cards, step_cards
from palpate.export.format import Format, refuse_mechanisms
from palpate.export.quadratic import RESOLUTIONS, quadratic_mesh
from palpate.materials.flow.row import FIRST
from palpate.specification import Specification

SUBROUTINE = "burgers.f"
PER_LINE = 8


def creeps(specification: Specification) -> bool:
    """Tell whether the law needs the user material."""
    return any(value > 0 for name, value in specification.parameters.items() if name.endswith("coefficient"))


def user_constants(coefficients: np.ndarray) -> np.ndarray:
    """Return PROPS of the user material from the coefficients of the radial equation."""
    return np.concatenate([coefficients[:YIELD], coefficients[VOIGT:]])


def deck(specification: Specification) -> str:
    """Return the text of the deck.

    Raises
    ------
    InputError
        For mechanisms, and for creep and yielding together.
    """
    refuse_mechanisms(specification)
    if creeps(specification) and "yield_stress" in specification.parameters:
        raise InputError(
            "the user material has no yielding", remedy="use nonlinear_burgers", place="material.yield_stress"
        )
    mesh = quadratic_mesh(specification, RESOLUTIONS[specification.accuracy])
    material = _user_material(specification) if creeps(specification) else material_cards(specification)
    friction = specification.indenter.friction
    sections = [
        "*MATERIAL, NAME=INDENTER",
        "*ELASTIC",
        f"{specification.parameters['youngs_modulus']:.12g}, 0.3",
        "*SOLID SECTION, ELSET=TIP, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=RINGS, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=INDENTER, MATERIAL=INDENTER",
        "*SURFACE INTERACTION, NAME=CONTACT",
        *(["*FRICTION", f"{friction:.6g},"] if friction else []),
        "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE",
        "SURFACE, FACE",
    ]
    return "\n".join(["*HEADING", *mesh_cards(mesh), *material, *sections, *_steps(specification)])


def _user_material(specification: Specification) -> list[str]:
    constants = user_constants(specification.coefficients)
    elements = (len(constants) - STEADY - 2) // 3
    lines = ["*MATERIAL, NAME=BODY", f"*USER MATERIAL, CONSTANTS={len(constants)}"]
    for k in range(0, len(constants), PER_LINE):
        lines.append(", ".join(f"{value:.12g}" for value in constants[k : k + PER_LINE]))
    return [*lines, "*DEPVAR", f"{4 * (1 + elements)},"]


def _steps(specification: Specification) -> list[str]:
    protocol = specification.protocol
    geometry = "YES" if specification.kinematics == "large" else "NO"
    header = f"*STEP, NLGEOM={geometry}, INC={20 * len(protocol.sample_time) + 1000}"
    output = ("*OUTPUT, HISTORY, FREQUENCY=1", f"*NODE OUTPUT, NSET={REFERENCE}", "U2, CF2")
    return [*amplitude_cards(protocol), *step_cards(protocol, header, "*STATIC", output)]


def write(specification: Specification, path: Path) -> None:
    """Write the deck, and the user material where it is needed, to the folder `path`."""
    text = deck(specification)
    path.mkdir(exist_ok=True)
    (path / "indentation.inp").write_text(text, encoding="ascii")
    if creeps(specification):
        (path / SUBROUTINE).write_bytes(files("palpate.export").joinpath(SUBROUTINE).read_bytes())


FORMAT = Format("abaqus", "Abaqus/Standard", write)
