"""The bodies whose curves are given, and what a diagnosis with the base model's law, cone and angle should name.

The code that wrote the curves is axisymmetric, with bilinear quadrilaterals on a polar mesh, nodal contact, small
strains and the trapezoidal rule. Its curves differ from those of `accuracy: finest` by 0.02 to 0.056 % of the depth
within a test and by up to 0.2 % in level.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

SHARED = {"transient_exponent": 0.3, "retardation_time": 0.25}  # held in the study, as in the bodies
A = {"youngs_modulus": 2.95, "steady_coefficient": 0.055, "steady_exponent": 0.21, "transient_coefficient": 0.22}
B = {"youngs_modulus": 3.55, "steady_coefficient": 0.08, "steady_exponent": 0.27, "transient_coefficient": 0.29}
C = {"youngs_modulus": 3.2, "steady_coefficient": 0.042, "steady_exponent": 0.19, "transient_coefficient": 0.19}


@dataclass(frozen=True)
class Body:
    """What a file of curves conceals.

    Parameters
    ----------
    parameters
        Of the law.
    mechanisms
        What the base model lacks.
    """

    parameters: Mapping[str, float]
    mechanisms: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


BODIES = {
    "burgers_a": Body(A | SHARED),
    "burgers_b": Body(B | SHARED),
    "burgers_b_radius_260nm": Body(B | SHARED, {"tip_rounding": {"radius": 260.0}}),
    "burgers_b_angle_71.8": Body(B | SHARED, {"tip_angle": {"half_angle": 71.8}}),
    "burgers_b_film_6um_40GPa": Body(
        B | SHARED, {"film_on_substrate": {"thickness": 6000.0, "substrate_modulus": 40.0}}
    ),
    "burgers_a_second_voigt": Body(
        A | SHARED, {"second_voigt": {"coefficient": 0.16, "exponent": 0.25, "retardation_time": 14.0}}
    ),
    "burgers_c_yield": Body(C | SHARED, {"plastic_yield": {"yield_stress": 0.11, "hardening": 0.3}}),
}
