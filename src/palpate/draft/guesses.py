"""Guessed ranges of a law's parameters, about what recordings tell of the solid without simulations."""

from __future__ import annotations

import math

from palpate.draft.solid import Solid
from palpate.errors import InputError
from palpate.materials import law_of

EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml


def ranges(law: str, solid: Solid, shortest: float) -> dict[str, tuple[float, ...]]:
    """Return guessed ranges of a law's parameters; one value holds a parameter constant.

    A solid that creeps is stiffer than an elastic one as deep, and its unloadings tell no modulus, as creep goes on in
    them. One that yields unloads elastically, but a frame left in the depth flattens that. The yield stress lies
    between a fifth and nine tenths of the hardness (Johnson, Contact Mechanics, 1985, section 6.3). Creep is that of an
    epoxy whose stresses grow with the modulus, from none to about three times as much; what recovers does so in a time
    between a five-hundredth and four tenths of the shortest loading. No range leaves that of its parameter.

    Parameters
    ----------
    shortest
        Shortest time of loading among the tests [s].

    Raises
    ------
    InputError
        When the law yields and no unloading tells a modulus, or has parameters of which recordings tell nothing.
    """
    declared = law_of(law).declared({})
    names = [parameter.name for parameter in declared]
    middle, low, high = 1.5 * solid.secant, 0.8 * solid.secant, 3.0 * solid.secant
    if "yield_stress" in names:
        if math.isnan(solid.modulus):
            raise InputError(
                f"no unloading tells a modulus, which the ranges of {law} are guessed from",
                remedy="use --law nonlinear_burgers, or write the study by hand",
            )
        middle, low, high = solid.modulus, 0.4 * solid.modulus, 1.8 * solid.modulus
    stress = middle / EPOXY_MODULUS
    known: dict[str, tuple[float, ...]] = {
        "youngs_modulus": (low, high),
        "yield_stress": (0.2 * solid.hardness, 0.9 * solid.hardness),
        "hardening": (0.0, 0.1 * middle),
        "steady_coefficient": (0.0, 0.2 * stress**-1.5),
        "steady_exponent": (0.1, 0.8),
        "transient_coefficient": (0.0, 0.6 * stress**-1.6),
        "transient_exponent": (0.1, 0.8),
        "retardation_time": (0.002 * shortest, 0.4 * shortest),
        "strength": (0.05 * middle, 0.3 * middle),
        "hardening_exponent": (0.1, 0.8),
        "saturation_stress": (0.9 * solid.hardness, 1.5 * solid.hardness),
        "saturation_strain": (0.02, 0.3),
        "pressure_coefficient": (0.0, 0.3),
        "reference_rate": (1e-8, 1e-4),
        "eyring_stress": (0.02 * solid.hardness, 0.1 * solid.hardness),
        "spectrum_coefficient": (0.0, 0.1 / middle),
        "spectrum_exponent": (-0.2, 0.2),
    }
    if law == "burgers_plasticity":
        known |= {"steady_coefficient": (0.0,), "steady_exponent": (0.0,), "transient_exponent": (0.0,)}
        known |= {"transient_coefficient": (0.0, 0.3 / middle), "retardation_time": (0.5 * shortest,)}
    unknown = [p.name for p in declared if p.default is None and p.name not in {*known, "poisson_ratio"}]
    if unknown:
        raise InputError(
            f"no range of {unknown[0]} can be guessed, a parameter of {law}",
            remedy="draft with another --law, or write the study by hand",
        )
    return {
        parameter.name: tuple(min(max(value, parameter.lower), parameter.upper) for value in known[parameter.name])
        for parameter in declared
        if parameter.name in known
    }
