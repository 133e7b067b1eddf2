"""What of a law's flow other programs know: power-law creep, Voigt elements, and a yield stress without pressure.

Beside a yield stress that does not harden they know a back stress, too.
"""

from __future__ import annotations

import numpy as np

from palpate.errors import InputError
from palpate.materials import LAWS, law_of
from palpate.materials.bilinear_plasticity import linear_hardening
from palpate.materials.law import BackStress, Creep, LinearVoigt, Term, Voigt, Yield
from palpate.materials.nonlinear_burgers import power_of_stress
from palpate.study.specification import Specification

STRAINS = np.concatenate([[0.0], np.geomspace(1e-5, 10.0, 61)])  # of a table of the yield stress


def terms_of(specification: Specification) -> list[Term]:
    """Return the terms of the law."""
    return list(law_of(specification.model).terms(specification.parameters))


def refuse(specification: Specification, program: str, unknown: Term) -> InputError:
    """Return the error that names the law which declares a term that a `program` does not know."""
    values, function = specification.parameters, _function(unknown)
    key = specification.model
    for part in law_of(specification.model).parts:
        own = {p.name: values[p.name] for p in LAWS[part].declared(values) if p.name in values}
        if any(_function(term) is function for term in LAWS[part].terms(own)):
            key = part
    return InputError(
        f"{program} does not know the law {key}", remedy="use another format or law", place="material.model"
    )


def steady_creep(specification: Specification, program: str) -> tuple[float, float]:
    """Return C_s and m_s of steady creep, zero without; raises `InputError` for other creep, and for pressure."""
    creep = [term for term in terms_of(specification) if isinstance(term, Creep)]
    for number, term in enumerate(creep):
        if term.fluidity is not power_of_stress or number > 0:
            raise refuse(specification, program, term)
    coefficient, power = creep[0].numbers if creep else (0.0, 0.0)
    return coefficient, 0.5 * power


def voigt_elements(specification: Specification) -> list[tuple[float, float, float]]:
    """Return C_t, m_t and t_eps of each Voigt element."""
    found = []
    for term in terms_of(specification):
        if isinstance(term, LinearVoigt):
            found.append((term.compliance, 0.0, term.time))
        elif isinstance(term, Voigt):
            found.append((term.numbers[0], 0.5 * term.numbers[1], term.time))
    return found


def strength(specification: Specification, program: str) -> list[tuple[float, float]] | None:
    """Return a table of yield stress [GPa] and plastic strain; none where the law does not yield.

    Raises
    ------
    InputError
        When the yield stress depends on the pressure.
    """
    for term in terms_of(specification):
        if isinstance(term, Yield):
            if term.pressed:
                raise refuse(specification, program, term)
            strains = (0.0, 10.0) if term.strength is linear_hardening else STRAINS
            return [(float(term.strength(term.numbers, 0, a, 0.0)[0]), float(a)) for a in strains]  # type: ignore[index]
    return None


def kinematic_modulus(specification: Specification, program: str) -> float:
    """Return the modulus of the back stress [GPa], zero without.

    Raises
    ------
    InputError
        Where anything but a yield stress that does not harden acts beside it.
    """
    terms = terms_of(specification)
    for back in terms:
        if isinstance(back, BackStress):
            beside = [term for term in terms if term is not back]
            if not all(isinstance(term, Yield) and term.strength is linear_hardening for term in beside):
                raise refuse(specification, program, back)
            if specification.parameters["hardening"] > 0.0:
                raise InputError(
                    f"{program} has no kinematic hardening beside isotropic hardening",
                    remedy="set hardening to 0",
                    place="material.hardening",
                )
            return back.modulus
    return 0.0


def _function(term: Term) -> object:
    return getattr(term, "fluidity", None) or getattr(term, "strength", None) or type(term)
