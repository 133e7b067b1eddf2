"""An input deck for CalculiX: linear elasticity, steady creep (its built-in Norton law) or plasticity.

Norton's law, rate = A q^n with q von Mises' stress, is steady creep d e_s/dt = C_s J2^m_s s with n = 2 m_s + 1 and
A = (2/3) C_s 3^(-m_s), because q = sqrt(3 J2) and the equivalent creep strain is sqrt(2/3) |e_s|. Units um, mN, s, so
stresses are in GPa. Axisymmetric second-order elements with reduced integration, small strains, a rigid indenter,
surface-to-surface penalty contact with Coulomb friction. Depth is the tip's initial overlap plus the rise of the
body's far boundary. CalculiX finds no contact between bodies that only touch, hence the overlap; it lets an overlap
become contact over the first step, hence a first, very short step in which the body is held.

Source: G. Dhondt, CalculiX CrunchiX User's Manual version 2.20, *CREEP, *PLASTIC, *CONTACT PAIR, *TIME POINTS.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.output.export.cards import (
    REFERENCE,
    amplitude_cards,
    friction_cards,
    indenter_cards,
    mesh_cards,
    step_cards,
)
from palpate.output.export.format import Format, check_exportable
from palpate.output.export.quadratic import RESOLUTIONS, QuadraticMesh, quadratic_mesh
from palpate.output.export.terms import kinematic_modulus, steady_creep, strength, voigt_elements
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification

PENETRATION = 5e-4  # of the depth at the edge of contact, that the mean pressure presses the surface into the tip


def norton(steady_coefficient: float, steady_exponent: float) -> tuple[float, float]:
    """Return A [GPa^-n/s] and n of Norton's law for steady creep."""
    return 2 / 3 * steady_coefficient * 3.0**-steady_exponent, 2 * steady_exponent + 1


def material_cards(specification: Specification, program: str = "CalculiX") -> list[str]:
    """Return the material's cards; raises `InputError` for what the built-in laws cannot represent."""
    values = specification.parameters
    cards = ["*MATERIAL, NAME=BODY", "*ELASTIC", f"{values['youngs_modulus']:.12g}, {values['poisson_ratio']:.12g}"]
    hardening = strength(specification, program)
    kinematic, (coefficient, exponent) = kinematic_modulus(specification, program), steady_creep(specification, program)
    for number, (compliance, _, _) in enumerate(voigt_elements(specification), 1):
        if compliance > 0:
            raise InputError(
                f"{program} has no Voigt elements, and element {number} of {specification.model} retards",
                remedy="set its coefficient to 0 or use --format abaqus",
                place="material",
            )
    if hardening is not None:
        if coefficient > 0:
            raise InputError(
                f"{program} has no law with creep and hardening",
                remedy="set steady_coefficient to 0",
                place="material.steady_coefficient",
            )
        cards.append("*PLASTIC, HARDENING=KINEMATIC" if kinematic else "*PLASTIC")
        cards += [f"{stress + kinematic * strain:.12g}, {strain:.12g}" for stress, strain in hardening]
    if coefficient > 0:
        factor, power = norton(coefficient, exponent)
        cards += ["*CREEP, LAW=NORTON", f"{factor:.12g}, {power:.12g}, 0."]
    return cards


def deck(specification: Specification, resolution: Resolution | None = None) -> str:
    """Return the text of the deck.

    Raises
    ------
    InputError
        For mechanisms, large strains, and laws that CalculiX does not have.
    """
    check_exportable(specification)
    if specification.kinematics == "large":
        raise InputError(
            "CalculiX' built-in laws are neo-Hookean at large strains, not palpate's",
            remedy="write kinematics: small, or use --format abaqus",
            place="kinematics",
        )
    material = material_cards(specification)
    mesh = quadratic_mesh(specification, resolution or RESOLUTIONS[specification.accuracy])
    return "\n".join(
        [
            *mesh_cards(mesh),
            *material,
            *contact_cards(specification, mesh),
            *_steps(specification),
        ]
    )


def contact_cards(specification: Specification, mesh: QuadraticMesh) -> list[str]:
    """Return the sections and the contact between body and indenter."""
    pressure = specification.protocol.max_load / (np.pi * mesh.contact_radius**2)
    stiffness = pressure / (PENETRATION * Profile.of(specification.indenter).depth_for(mesh.contact_radius))
    behaviour = ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:.6g}"]
    friction = friction_cards(specification.indenter.friction, stiffness)
    return indenter_cards(specification.parameters["youngs_modulus"], [*behaviour, *friction])


def sample_cards(protocol: Protocol) -> list[str]:
    """Return the times of which results are printed."""
    return ["*TIME POINTS, NAME=SAMPLES, TIME=TOTAL TIME", *(f"{time:.12g}," for time in protocol.sample_time)]


def _steps(specification: Specification) -> list[str]:
    protocol = specification.protocol
    creeps = steady_creep(specification, "CalculiX")[0] > 0
    output = (f"*NODE PRINT, NSET={REFERENCE}, TIME POINTS=SAMPLES", "U")
    return [
        *amplitude_cards(protocol),
        *sample_cards(protocol),
        *step_cards(protocol, "", "*VISCO, CETOL=1." if creeps else "*STATIC", output),
    ]


def write(specification: Specification, path: Path) -> None:
    """Write the deck to `path`; raises `InputError` for what CalculiX cannot represent."""
    path.write_text(deck(specification), encoding="ascii")


FORMAT = Format("calculix", write)
