"""Guessed ranges of a law's parameters, from what recordings show of the solid without simulations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from palpate.draft.solid import Solid
from palpate.errors import InputError
from palpate.materials import law_of

EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml
POINTS = {1: 16, 2: 32, 3: 64}  # snapshots for so many free parameters; more would lie too near to each other
MOST_POINTS = 128  # snapshots for more of them


def ranges(law: str, solid: Solid, shortest: float) -> dict[str, tuple[float, ...]]:
    """Return guessed ranges of a law's parameters; one value holds a parameter constant.

    A solid that creeps is stiffer than an elastic one as deep, and its unloadings give no modulus, as creep goes on in
    them, unless it is stiffer than a polymer. One that yields unloads elastically, but a frame left in the depth
    flattens that. Without unloading its modulus is thought of as three times that of the elastic body as deep, which
    has the hardness of a metal. The yield stress lies between a fifth and nine tenths of the hardness (Johnson, Contact
    Mechanics, 1985, section 6.3). Creep is that of an epoxy whose stresses grow with the modulus, from none to about
    three times as much; what recovers does so in a time between a five-hundredth and four tenths of the shortest
    loading. Gels and rubbers, far below the stresses of plastics, creep in proportion to the stress. No range leaves
    that of its parameter.

    Parameters
    ----------
    shortest
        Shortest time of loading among the tests [s].

    Raises
    ------
    InputError
        When the law has parameters of which recordings show nothing.
    """
    declared = law_of(law).declared({})
    known = _known(law, [parameter.name for parameter in declared], solid, shortest)
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


def _known(law: str, names: list[str], solid: Solid, shortest: float) -> dict[str, tuple[float, ...]]:
    """Return the range of every parameter of which recordings show something, for a law with parameters `names`."""
    middle, low, high = _moduli(names, solid)
    hardness = 0.1 * solid.secant if math.isnan(solid.hardness) else solid.hardness
    stress = middle / EPOXY_MODULUS
    known: dict[str, tuple[float, ...]] = {
        "youngs_modulus": (low, high),
        "yield_stress": (0.2 * hardness, 0.9 * hardness),
        "hardening": (0.0, 0.1 * middle),
        "steady_coefficient": (0.0, 0.2 * stress**-1.5),
        "steady_exponent": (0.1, 0.8),
        "transient_coefficient": (0.0, 0.6 * stress**-1.6),
        "transient_exponent": (0.1, 0.8),
        "retardation_time": (0.002 * shortest, 0.4 * shortest),
        "strength": (0.05 * middle, 0.3 * middle),
        "hardening_exponent": (0.1, 0.8),
        "saturation_stress": (0.9 * hardness, 1.5 * hardness),
        "saturation_strain": (0.02, 0.3),
        "pressure_coefficient": (0.0, 0.3),
        "reference_rate": (1e-8, 1e-4),
        "eyring_stress": (0.02 * hardness, 0.1 * hardness),
        "spectrum_coefficient": (0.0, 0.1 / middle),
        "spectrum_exponent": (-0.2, 0.2),
    }
    if law == "burgers_plasticity":
        known |= {"steady_coefficient": (0.0,), "steady_exponent": (0.0,), "transient_exponent": (0.0,)}
        known |= {"transient_coefficient": (0.0, 0.3 / middle), "retardation_time": (0.5 * shortest,)}
    elif solid.soft:
        known |= {"steady_exponent": (0.0,), "transient_exponent": (0.0,)}
        known |= {"steady_coefficient": (0.0, 0.5 / (middle * shortest)), "transient_coefficient": (0.0, 1.0 / middle)}
    return known


def _moduli(names: list[str], solid: Solid) -> tuple[float, float, float]:
    """Return what the modulus may be for a law with parameters of these `names`: middle, least and largest [GPa]."""
    if "yield_stress" in names:
        if math.isnan(solid.modulus):
            return 3.0 * solid.secant, 0.8 * solid.secant, 10.0 * solid.secant
        return solid.modulus, 0.4 * solid.modulus, 1.8 * solid.modulus
    if names == ["youngs_modulus", "poisson_ratio"]:
        return solid.secant, 0.4 * solid.secant, 2.5 * solid.secant
    middle, low, high = 1.5 * solid.secant, 0.8 * solid.secant, 3.0 * solid.secant
    return (
        (middle, low, max(high, 1.5 * solid.modulus)) if solid.stiff and solid.modulus > middle else (middle, low, high)
    )


def points_for(guessed: Mapping[str, Sequence[float]]) -> int:
    """Return how many snapshots serve for ranges as `ranges` gives them."""
    return POINTS.get(sum(len(values) > 1 for values in guessed.values()), MOST_POINTS)
