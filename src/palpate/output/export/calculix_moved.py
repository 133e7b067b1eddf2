"""A deck for CalculiX at large strains: the body is moved onto the indenter, and the load is what the indenter bears.

Under a given load CalculiX finds no equilibrium once strains are large and the contact grows; under a given motion it
does. The elements of the rings are integrated fully, since those with reduced integration turn over. The innermost ring
is seven times as wide as at small strains, because the tip shears it.

Its plasticity at large strains is multiplicative, von Mises' with neo-Hookean elasticity, where palpate's elastic
strains are logarithmic: both agree to the order of the elastic strain, which is small in a body that yields.

Source: G. Dhondt, CalculiX CrunchiX User's Manual version 2.20, *STEP, *PLASTIC, *BOUNDARY; J.C. Simo, Comput. Methods
Appl. Mech. Eng. 66 (1988) 199-219, for its plasticity.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.errors import InputError
from palpate.output.export.calculix_deck import contact_cards, material_cards, sample_cards
from palpate.output.export.cards import REFERENCE, amplitude_cards, mesh_cards, step_cards
from palpate.output.export.format import check_exportable
from palpate.output.export.quadratic import RESOLUTIONS, QuadraticMesh
from palpate.study.specification import Specification

MOVED = ("*BOUNDARY, AMPLITUDE=LOAD", f"{REFERENCE}, 2, 2, 1.")
SHEARED = {accuracy: replace(resolution, inner=0.7) for accuracy, resolution in RESOLUTIONS.items()}
OUTPUT = (
    f"*NODE PRINT, NSET={REFERENCE}, TIME POINTS=SAMPLES",
    "U",
    "*NODE PRINT, NSET=FIXED, TOTALS=ONLY, TIME POINTS=SAMPLES",
    "RF",
)


def deck(specification: Specification, depth: np.ndarray, mesh: QuadraticMesh) -> str:
    """Return the text of the deck, which prints the rise of the body [um] and the force on the indenter [mN].

    Parameters
    ----------
    depth : ndarray, shape (k,)
        Depth [nm] at each of the protocol's knots; its loads do not count.
    mesh
        Of the body and the indenter, see `palpate.output.export.quadratic`.

    Raises
    ------
    InputError
        For mechanisms, small strains, and a body that does not yield.
    """
    check_exportable(specification)
    if "yield_stress" not in specification.parameters or specification.kinematics != "large":
        raise InputError(
            "CalculiX' laws agree with palpate's at large strains where the body yields alone",
            remedy="give it a yield_stress, or write kinematics: small",
            place="kinematics",
        )
    protocol = specification.protocol
    rise = np.maximum(1e-3 * depth - mesh.overlap, 0.0)
    return "\n".join(
        [
            *mesh_cards(mesh, rings="CAX8"),
            *material_cards(specification),
            *contact_cards(specification, mesh),
            *amplitude_cards(replace(protocol, knot_drive=rise)),
            *sample_cards(protocol),
            *step_cards(protocol, ", NLGEOM", "*STATIC", OUTPUT, MOVED),
        ]
    )
