"""Which law a draft states, or which family of laws, by how the tests load, creep in their holds and recover."""

from __future__ import annotations

import math

from palpate.draft.solid import STIFFEST_POLYMER, Solid

POLYMER, METAL, ELASTIC = "nonlinear_burgers", "bilinear_plasticity", "elastic"
ALL_RETURNED = 0.97  # of the work of loading; chosen: what a clean elastic test gives back but for noise and friction
SHOWN = 0.0005  # of the depth, that is no zero in per cent with one digit
NO_CREEP = 0.01  # of the depth, in a hold
BRITTLE = 0.06  # hardness over modulus; chosen: glasses and ceramics reach 0.07 to 0.13, hardened steels 0.04


def chosen_law(solid: Solid) -> tuple[str, str]:
    """Return the key of the law for a solid, and why.

    What is stiffer than any polymer yields (metals, glasses, ceramics); what gives all work back and does not creep is
    elastic; all else is taken for a polymer or a gel, which creeps.
    """
    if solid.stiff:
        by = "an elastic body as deep" if math.isnan(solid.modulus) else "unloading"
        value = solid.secant if math.isnan(solid.modulus) else solid.modulus
        return METAL, f"{by} gives {value:.3g} GPa; no polymer is stiffer than {STIFFEST_POLYMER:g}"
    if solid.returned > ALL_RETURNED and not solid.creep > NO_CREEP:
        return ELASTIC, f"unloading gives {solid.returned:.0%} of the work back"
    grows = f"grows by {solid.creep:.1%}" if solid.creep >= SHOWN else "does not grow"
    creep = "" if math.isnan(solid.creep) else f"; the depth {grows} in the hold"
    lost = f"; unloading gives {solid.returned:.0%} of the work back" if solid.returned >= 0.0 else ""
    return POLYMER, f"no stiffer than a polymer{creep}{lost}"


def family_of(solid: Solid) -> str:
    """Return the family of laws among which recordings of a solid choose; empty where they cannot, or need not."""
    if math.isnan(solid.returned):
        return ""
    if solid.stiff:
        return "glass" if solid.hardness > BRITTLE * solid.modulus else "metal"
    if chosen_law(solid)[0] == ELASTIC:
        return ""
    return "gel" if solid.soft else "polymer"
