"""A tip in words, as reports, the console and MLflow show it."""

from __future__ import annotations

from palpate.configuration.study_file import Study
from palpate.study.indenter import Indenter

SHAPES = {
    "cone": "cone",
    "sphere": "sphere",
    "sphero_cone": "rounded cone",
    "berkovich": "Berkovich pyramid",
    "area_function": "tip of a measured area function",
}


def tips_in_words(study: Study) -> str:
    """Return the study's tip in words, and those that conditions name."""
    return "; ".join(
        [tip_in_words(study.indenter), *(f"{name}: {tip_in_words(tip)}" for name, tip in study.tips.items())]
    )


def tip_in_words(tip: Indenter) -> str:
    """Return an indenter in words, with angle and radius where it has them, and friction and stiffness where stated."""
    facts = [SHAPES[tip.shape]]
    if tip.half_angle:
        facts.append(f"half-angle {tip.half_angle:g}°")
    if tip.radius:
        facts.append(f"radius {tip.radius:g} nm")
    if tip.friction:
        facts.append(f"friction {tip.friction:g}")
    if tip.compliance:
        facts.append(f"modulus {tip.modulus:g} GPa")
    return ", ".join(facts)
