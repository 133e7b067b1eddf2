"""Guessed ranges of a law's parameters, from what recordings show of the solid without simulations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from palpate.draft.solid import Solid
from palpate.errors import InputError
from palpate.materials import law_of

EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml
POINTS = {1: 16, 2: 32, 3: 64}  # snapshots for so many free parameters; more would lie too near to each other
MOST_POINTS = 128  # snapshots for more of them
USUAL = "usual values"
LIKE_EPOXY = "from none to about three times the creep of an epoxy at like stress"


class Guessed(NamedTuple):
    """What a parameter may be, one value where it is held constant, and why."""

    values: tuple[float, ...]
    why: str


def ranges(law: str, solid: Solid, shortest: float) -> dict[str, Guessed]:
    """Return guessed ranges of a law's parameters.

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
        p.name: Guessed(tuple(min(max(value, p.lower), p.upper) for value in known[p.name][0]), known[p.name][1])
        for p in declared
        if p.name in known
    }


def _known(law: str, names: list[str], solid: Solid, shortest: float) -> dict[str, tuple[tuple[float, ...], str]]:
    """Return range and reason of every parameter of which recordings show something, for a law with such `names`."""
    middle, low, high = _moduli(names, solid)
    hardness = 0.1 * solid.secant if math.isnan(solid.hardness) else solid.hardness
    stress = middle / EPOXY_MODULUS
    retarding = "a five-hundredth to four tenths of the shortest loading"
    steady: tuple[float, ...]
    known: dict[str, tuple[tuple[float, ...], str]] = {
        "youngs_modulus": ((low, high), _of_modulus(law, names, solid)),
        "yield_stress": ((0.2 * hardness, 0.9 * hardness), "a fifth to nine tenths of the hardness"),
        "hardening": ((0.0, 0.1 * middle), "up to a tenth of the modulus"),
        "steady_coefficient": ((0.0, 0.2 * stress**-1.5), LIKE_EPOXY),
        "steady_exponent": ((0.1, 0.8), USUAL),
        "transient_coefficient": ((0.0, 0.6 * stress**-1.6), LIKE_EPOXY),
        "transient_exponent": ((0.1, 0.8), USUAL),
        "retardation_time": ((0.002 * shortest, 0.4 * shortest), retarding),
        "strength": ((0.05 * middle, 0.3 * middle), "5 to 30 % of the modulus"),
        "hardening_exponent": ((0.1, 0.8), USUAL),
        "saturation_stress": ((0.9 * hardness, 1.5 * hardness), "0.9 to 1.5 times the hardness"),
        "saturation_strain": ((0.02, 0.3), USUAL),
        "pressure_coefficient": ((0.0, 0.3), USUAL),
        "reference_rate": ((1e-8, 1e-4), USUAL),
        "eyring_stress": ((0.02 * hardness, 0.1 * hardness), "2 to 10 % of the hardness"),
        "spectrum_coefficient": ((0.0, 0.1 / middle), "up to a tenth of the elastic compliance"),
        "spectrum_exponent": ((-0.2, 0.2), USUAL),
    }
    if law == "burgers_plasticity":
        steady, transient, reason = (0.0,), (0.0, 0.3 / middle), "linear creep beside the plastic flow"
        known["retardation_time"] = ((0.5 * shortest,), "half of the shortest loading")
    elif solid.soft:
        steady, transient = (0.0, 0.5 / (middle * shortest)), (0.0, 1.0 / middle)
        reason = "linear creep, as of gels and rubbers"
    else:
        return known
    known |= {"steady_coefficient": (steady, reason), "steady_exponent": ((0.0,), reason)}
    return known | {"transient_coefficient": (transient, reason), "transient_exponent": ((0.0,), reason)}


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


def _of_modulus(law: str, names: list[str], solid: Solid) -> str:
    """Return in words where the range of the modulus comes from."""
    if "yield_stress" in names:
        if math.isnan(solid.modulus):
            return f"no unloading gives a modulus; an elastic body as deep has one of {solid.secant:.3g} GPa"
        return f"about a modulus of {solid.modulus:.3g} and a hardness of {solid.hardness:.3g} GPa, by unloading"
    more = "" if law == "elastic" else "; creep requires a larger one"
    return f"an elastic body as deep has a modulus of {solid.secant:.3g} GPa{more}"


def points_for(guessed: Mapping[str, Guessed]) -> int:
    """Return how many snapshots serve for ranges as `ranges` gives them."""
    return POINTS.get(sum(len(found.values) > 1 for found in guessed.values()), MOST_POINTS)
