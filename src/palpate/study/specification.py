"""Everything on which a simulated curve depends, checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.errors import InputError
from palpate.materials import law_of
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specimen import Specimen, elastic_substrate, under_tip

ACCURACIES = ("standard", "medium", "fine", "finest")
KINEMATICS = ("large", "small")  # the first one where none is given


def finer(accuracy: str, degrees: int = 1) -> str:
    """Return the accuracy that is so many degrees finer, or the finest."""
    return ACCURACIES[min(ACCURACIES.index(accuracy) + degrees, len(ACCURACIES) - 1)]


@dataclass(frozen=True, eq=False)
class Specification:
    """Everything on which a simulated curve depends.

    Parameters
    ----------
    model
        Key of the constitutive law, or keys of several joined by ``+``.
    parameters
        Its parameters by name.
    indenter, protocol
        What presses, and how.
    kinematics
        ``large`` strains, unless ``small`` ones are asked for.
    accuracy
        ``standard``, ``medium``, ``fine`` or ``finest``.
    mechanisms
        Missing physics to simulate too: parameters by name for each key of `palpate.mechanisms`.
    film_thickness, substrate_modulus
        The material is a film [nm] on an elastic substrate [GPa], where the thickness is finite.
    size_length
        Length of the size effect [nm], see `palpate.study.specimen.Specimen.resistance`.
    adhesion
        Work that separates surface and tip [mJ/m^2].
    skin_contrast, skin_depth
        The modulus grows towards the surface, see `palpate.study.specimen.Specimen.softening`; the depth in nm.
    tip
        Name of the indenter among those of a study: effects of another tip do not act; empty for the study's own.

    Raises
    ------
    InputError
        On anything unknown, missing or outside its physical range.
    """

    model: str
    parameters: Mapping[str, float]
    indenter: Indenter
    protocol: Protocol
    kinematics: str = KINEMATICS[0]
    accuracy: str = "standard"
    mechanisms: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    film_thickness: float = math.inf
    substrate_modulus: float = 0.0
    size_length: float = 0.0
    adhesion: float = 0.0
    skin_contrast: float = 0.0
    skin_depth: float = 0.0
    tip: str = field(default="", compare=False)
    coefficients: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        law = law_of(self.model)
        for key, value, known in (
            ("accuracy", self.accuracy, ACCURACIES),
            ("kinematics", self.kinematics, KINEMATICS),
        ):
            if value not in known:
                raise InputError(f"{key} is {value!r}", remedy=f"use one of: {', '.join(known)}", place=key)
        object.__setattr__(self, "model", law.key)
        object.__setattr__(self, "parameters", law.check(self.parameters))
        object.__setattr__(self, "coefficients", law.coefficients(self.parameters))

    @property
    def specimen(self) -> Specimen:
        """The body that a rigid indenter presses in place of the real one; the indenter's own compliance is in it."""
        film, thickness, tip = self.coefficients, self.film_thickness, self.indenter.compliance
        substrate = None
        if math.isfinite(thickness):
            substrate = under_tip(elastic_substrate(film, self.substrate_modulus), tip)
        skin = self.skin_contrast, self.skin_depth
        return Specimen(under_tip(film, tip), thickness, substrate, self.size_length, self.adhesion, *skin)


def of_equivalent_cone(specification: Specification) -> Specification:
    """Return what is simulated in place of an indentation by a pyramid; the same under other tips."""
    return replace(specification, indenter=specification.indenter.equivalent_cone)


def axisymmetric_only(feature: str, place: str) -> InputError:
    """Return the error for a feature that exists for axisymmetric indenters only."""
    return InputError(
        f"not available under a berkovich pyramid: {feature}",
        remedy="leave it out, or use the equivalent cone of half-angle 70.3",
        place=place,
    )
