"""Guessed ranges of a law's parameters, from what recordings show of the solid without simulations."""

from __future__ import annotations

import math
from collections.abc import Mapping

from palpate.draft.solid import Solid
from palpate.errors import InputError
from palpate.materials import law_of
from palpate.materials.first_guess import Glimpse, Guessed

POINTS = {1: 16, 2: 32, 3: 64}  # snapshots for so many free parameters; more would lie too near to each other
MOST_POINTS = 128  # snapshots for more of them


def ranges(law: str, solid: Solid, shortest: float) -> dict[str, Guessed]:
    """Return guessed ranges of a law's parameters; the law itself guesses those of its flow.

    A solid that creeps is stiffer than an elastic one as deep, and its unloadings give no modulus, as creep goes on in
    them, unless it is stiffer than a polymer. One that yields unloads elastically, but a frame left in the depth
    flattens that. Without unloading its modulus is thought of as three times that of the elastic body as deep, which
    has the hardness of a metal. No range leaves that of its parameter.

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
    names = [parameter.name for parameter in declared]
    middle, low, high = _moduli(names, solid)
    hardness = 0.1 * solid.secant if math.isnan(solid.hardness) else solid.hardness
    known = {"youngs_modulus": Guessed((low, high), _of_modulus(law, names, solid))}
    known |= law_of(law).guess(Glimpse(middle, hardness, shortest, solid.soft))
    unknown = [p.name for p in declared if p.default is None and p.name not in {*known, "poisson_ratio"}]
    if unknown:
        raise InputError(
            f"no range of {unknown[0]} can be guessed, a parameter of {law}",
            remedy="draft with another --law, or write the study by hand",
        )
    return {
        p.name: known[p.name]._replace(values=tuple(min(max(v, p.lower), p.upper) for v in known[p.name].values))
        for p in declared
        if p.name in known
    }


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
