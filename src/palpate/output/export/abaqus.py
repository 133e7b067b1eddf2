"""A folder for Abaqus/Standard: an input deck, and a user material where the law creeps.

The deck is the CalculiX one in Abaqus' terms, with its finite-sliding surface-to-surface contact. Elasticity and
plasticity are Abaqus' own laws; power-law creep with any number of Voigt elements, linear ones among them, is the
Fortran subroutine `burgers.f` beside this module, with the update of `palpate.materials.flow.radial`. At large
strains both programs relate true stress to logarithmic strain; Abaqus integrates it in its corotational frame, which
agrees with `palpate.solver.axisymmetric.hencky` only while the principal axes keep still.

Source: Abaqus Analysis User's Guide, *USER MATERIAL, *CONTACT PAIR; Abaqus User Subroutines Reference Guide, UMAT.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.materials.flow.row import BULK, SHEAR
from palpate.output.export.calculix_deck import material_cards
from palpate.output.export.cards import REFERENCE, amplitude_cards, indenter_cards, mesh_cards, step_cards
from palpate.output.export.format import Format, check_exportable
from palpate.output.export.quadratic import RESOLUTIONS, quadratic_mesh
from palpate.output.export.terms import kinematic_modulus, steady_creep, strength, voigt_elements
from palpate.study.specification import Specification

SUBROUTINE, PROGRAM = "burgers.f", "Abaqus"
PER_LINE = 8  # constants; the keyword takes no more


def creeps(specification: Specification) -> bool:
    """Return whether the law needs the user material."""
    return steady_creep(specification, PROGRAM)[0] > 0.0 or any(c > 0.0 for c, _, _ in voigt_elements(specification))


def user_constants(specification: Specification) -> np.ndarray:
    """Return PROPS (n,) of the user material: G, K, C_s, m_s, then C_t, m_t and t_eps of each Voigt element."""
    row, elements = specification.coefficients, voigt_elements(specification)
    return np.array([row[SHEAR], row[BULK], *steady_creep(specification, PROGRAM), *np.ravel(elements)])


def deck(specification: Specification) -> str:
    """Return the text of the deck.

    Raises
    ------
    InputError
        For mechanisms, for laws that neither program nor user material knows, and for creep and yielding together.
    """
    check_exportable(specification)
    kinematic_modulus(specification, PROGRAM)
    if creeps(specification) and strength(specification, PROGRAM) is not None:
        raise InputError(
            "the user material has no yielding", remedy="use a law that only creeps", place="material.yield_stress"
        )
    mesh = quadratic_mesh(specification, RESOLUTIONS[specification.accuracy])
    material = _user_material(specification) if creeps(specification) else material_cards(specification, PROGRAM)
    friction = specification.indenter.friction
    interaction = ["*FRICTION", f"{friction:.6g},"] if friction else []
    sections = indenter_cards(specification.parameters["youngs_modulus"], interaction)
    return "\n".join(["*HEADING", *mesh_cards(mesh), *material, *sections, *_steps(specification)])


def _user_material(specification: Specification) -> list[str]:
    constants = user_constants(specification)
    elements = (len(constants) - 4) // 3
    lines = ["*MATERIAL, NAME=BODY", f"*USER MATERIAL, CONSTANTS={len(constants)}"]
    for k in range(0, len(constants), PER_LINE):
        lines.append(", ".join(f"{value:.12g}" for value in constants[k : k + PER_LINE]))
    return [*lines, "*DEPVAR", f"{4 * (1 + elements)},"]


def _steps(specification: Specification) -> list[str]:
    protocol = specification.protocol
    geometry = f", NLGEOM={'YES' if specification.kinematics == 'large' else 'NO'}"
    output = ("*OUTPUT, HISTORY, FREQUENCY=1", f"*NODE OUTPUT, NSET={REFERENCE}", "U2, CF2")
    return [*amplitude_cards(protocol), *step_cards(protocol, geometry, "*STATIC", output)]


def write(specification: Specification, path: Path) -> None:
    """Write the deck, and the user material where it is needed, to the folder `path`."""
    text = deck(specification)
    path.mkdir(exist_ok=True)
    (path / "indentation.inp").write_text(text, encoding="ascii")
    if creeps(specification):
        (path / SUBROUTINE).write_bytes(files("palpate.output.export").joinpath(SUBROUTINE).read_bytes())


FORMAT = Format("abaqus", write)
