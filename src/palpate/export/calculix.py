"""An input deck for CalculiX: linear elasticity, steady creep (its built-in Norton law) or bilinear plasticity.

Norton's law, rate = A q^n with q von Mises' stress, is steady creep d e_s/dt = C_s J2^m_s s with n = 2 m_s + 1 and
A = (2/3) C_s 3^(-m_s), because q = sqrt(3 J2) and the equivalent creep strain is sqrt(2/3) |e_s|. Units um, mN, s, so
stresses are in GPa. Axisymmetric second-order elements with reduced integration, small strains, a rigid indenter
without friction, surface-to-surface penalty contact. Depth is the tip's initial overlap plus the rise of the body's far
boundary. CalculiX finds no contact between bodies that only touch, hence the overlap; it lets an overlap vanish over
the first step, hence a first step of a millionth of the test's duration with a load to match.

Source: G. Dhondt, CalculiX CrunchiX User's Manual version 2.20, *CREEP, *PLASTIC, *CONTACT PAIR, *TIME POINTS.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.errors import InputError
from palpate.export.format import Format, refuse_mechanisms
from palpate.export.quadratic import RESOLUTIONS, QuadraticMesh, quadratic_mesh
from palpate.fem.mesh import Resolution
from palpate.specification import Specification

STIFFNESS = 1000.0
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


def norton(steady_coefficient: float, steady_exponent: float) -> tuple[float, float]:
    """Return A [GPa^-n/s] and n of Norton's law for steady creep."""
    return 2 / 3 * steady_coefficient * 3.0**-steady_exponent, 2 * steady_exponent + 1


def material_cards(specification: Specification) -> list[str]:
    """Return the material's cards; raises `InputError` for what the built-in laws cannot represent."""
    values = specification.parameters
    cards = ["*MATERIAL, NAME=BODY", "*ELASTIC", f"{values['youngs_modulus']:.12g}, {values['poisson_ratio']:.12g}"]
    creeps = values.get("steady_coefficient", 0.0) > 0
    for name, value in values.items():
        if name.startswith("transient_coefficient") and value > 0:
            raise InputError(
                f"{name} = {value:g}: CalculiX has no Voigt elements",
                remedy="set it to 0 or use --format abaqus",
                place=f"material.{name}",
            )
    if "yield_stress" in values:
        if creeps:
            raise InputError(
                "CalculiX has no law with creep and linear hardening",
                remedy="set steady_coefficient to 0 or use --format abaqus",
                place="material.steady_coefficient",
            )
        first, slope = values["yield_stress"], values["hardening"]
        cards += ["*PLASTIC", f"{first:.12g}, 0.", f"{first + 10 * slope:.12g}, 10."]
    if creeps:
        factor, exponent = norton(values["steady_coefficient"], values["steady_exponent"])
        cards += ["*CREEP, LAW=NORTON", f"{factor:.12g}, {exponent:.12g}, 0."]
    return cards


def deck(specification: Specification, resolution: Resolution | None = None) -> str:
    """Return the text of the deck.

    Raises
    ------
    InputError
        For mechanisms, large strains, and laws that CalculiX does not have.
    """
    refuse_mechanisms(specification)
    if specification.kinematics == "large":
        raise InputError(
            "CalculiX measures large strains in another way than palpate", remedy="use small", place="kinematics"
        )
    material = material_cards(specification)
    mesh = quadratic_mesh(specification, resolution or RESOLUTIONS[specification.accuracy])
    return "\n".join(
        [
            *_mesh_cards(mesh),
            *material,
            *_contact_cards(specification, mesh),
            *_step_cards(specification, onset_of(specification)),
        ]
    )


def _mesh_cards(mesh: QuadraticMesh) -> list[str]:
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
    for name, elements in (("SURFACE", surface), ("FACE", behind)):
        lines += [f"*SURFACE, NAME={name}, TYPE=ELEMENT", *(f"{element}, S1" for element in elements)]
    for name, nodes in (("AXIS", mesh.axis), ("FAR", mesh.far), ("FIXED", np.unique(mesh.indenter))):
        lines += [f"*NSET, NSET={name}", *(f"{node + 1}," for node in nodes)]
    lines += [f"*NSET, NSET={REFERENCE}", f"{mesh.far[0] + 1},"]
    for node in mesh.far[1:]:
        lines += ["*EQUATION", "2", f"{node + 1}, 2, 1., {mesh.far[0] + 1}, 2, -1."]
    lines += ["*BOUNDARY", "AXIS, 1, 1", "FAR, 1, 1", "FIXED, 1, 2"]
    return lines


def _contact_cards(specification: Specification, mesh: QuadraticMesh) -> list[str]:
    values = specification.parameters
    stiffness = STIFFNESS * values["youngs_modulus"] / mesh.contact_radius
    return [
        "*MATERIAL, NAME=INDENTER",
        "*ELASTIC",
        f"{values['youngs_modulus']:.12g}, 0.3",
        "*SOLID SECTION, ELSET=TIP, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=RINGS, MATERIAL=BODY",
        "*SOLID SECTION, ELSET=INDENTER, MATERIAL=INDENTER",
        "*SURFACE INTERACTION, NAME=CONTACT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{stiffness:.6g}",
        "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE",
        "SURFACE, FACE",
    ]


def _step_cards(specification: Specification, onset: Onset) -> list[str]:
    protocol = specification.protocol
    procedure = "*VISCO, CETOL=1." if specification.parameters.get("steady_coefficient", 0.0) > 0 else "*STATIC"
    later = protocol.knot_time > onset.end
    times = np.concatenate([[0.0, onset.time, onset.end], protocol.knot_time[later]])
    loads = np.concatenate([[0.0, onset.load, onset.load], protocol.knot_load[later]])
    lines: list[str] = ["*AMPLITUDE, NAME=LOAD, TIME=TOTAL TIME"]
    lines += [f"{t:.12g}, {p:.12g}" for t, p in zip(times, loads, strict=True)]
    lines += ["*TIME POINTS, NAME=SAMPLES, TIME=TOTAL TIME", *(f"{t:.12g}," for t in protocol.sample_time)]
    ends = np.concatenate([[0.0, onset.time], protocol.knot_time[1:]])
    interval = float(np.max(np.diff(protocol.sample_time, prepend=0.0)))
    for k, duration in enumerate(np.diff(ends)):
        longest = min(interval, duration)
        lines += [
            f"*STEP, INC={20 * len(protocol.sample_time) + 1000}",
            procedure if k else "*STATIC",
            f"{longest if k else 0.2 * duration:.12g}, {duration:.12g}, {1e-6 * duration:.6g}, {longest:.12g}",
            "*CLOAD, AMPLITUDE=LOAD",
            f"{REFERENCE}, 2, 1.",
            *((f"*NODE PRINT, NSET={REFERENCE}, TIME POINTS=SAMPLES", "U") if k else ()),
            "*END STEP",
        ]
    return [*lines, ""]


def write(specification: Specification, path: Path) -> None:
    """Write the deck to `path`; raises `InputError` for what CalculiX cannot represent."""
    path.write_text(deck(specification), encoding="ascii")


FORMAT = Format("calculix", "CalculiX", write)
