"""The tips of a study: its own, and those that conditions name under ``indenter``.

One condition describes a tip of its own in full, others name it. All tips press the same material on the same
instrument; what belongs to a tip alone, such as its rounding, is named after it, ``tip_rounding[NAME].radius``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from palpate.configuration.checked_file import suggestion
from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError, part_of
from palpate.mechanisms import MECHANISMS
from palpate.study.indenter import Indenter

DESCRIBE = "describe it at one condition, {name: NAME, shape: SHAPE, ...}, or name one that is described"


def indenters_of(study: StudyFile) -> tuple[Indenter, dict[str, Indenter]]:
    """Return the tip of a study, and those that its conditions describe, by their names.

    Parameters
    ----------
    study
        Its file.

    Raises
    ------
    InputError
        When a tip is none, is described in two ways or nowhere, or every condition has one of its own.
    """
    with part_of("indenter"):
        own = _indenter(study.indenter.model_dump())
    found: dict[str, Indenter] = {}
    for k, entry in enumerate(study.conditions):
        given = entry.indenter
        if not isinstance(given, Mapping):
            continue
        with part_of(f"conditions[{k}] ({entry.name}).indenter"):
            name = given["name"]
            tip = _indenter({key: value for key, value in given.items() if key != "name"})
            if found.setdefault(name, tip) != tip:
                raise InputError(
                    f"another tip is called {name!r}, too", remedy="rename one, or describe it once", place="name"
                )
    for k, entry in enumerate(study.conditions):
        name = tip_name(entry.indenter)
        if name and name not in found:
            raise InputError(
                f"tip {name!r} is described nowhere{suggestion(name, found)}",
                remedy=DESCRIBE,
                place=f"conditions[{k}] ({entry.name}).indenter",
            )
    if all(entry.indenter for entry in study.conditions):
        raise InputError(
            "no condition is tested with this tip",
            remedy="make one of the conditions' tips the study's, and leave it out there",
            place="indenter",
        )
    return own, found


def tip_name(given: Mapping[str, Any] | str | None) -> str:
    """Return the name of the tip that a condition gives; empty for the study's."""
    return str(given["name"]) if isinstance(given, Mapping) else given or ""


def _indenter(given: Mapping[str, Any]) -> Indenter:
    """Return an indenter; raises `InputError` with the place within it."""
    if "poisson_ratio" in given and "modulus" not in given:
        raise InputError(
            "a rigid tip has no Poisson's ratio", remedy="add its modulus, or leave it out", place="poisson_ratio"
        )
    return Indenter.from_mapping(given)


def check_tips(study: StudyFile, tips: Mapping[str, Indenter]) -> None:
    """Refuse mechanisms, such as ``tip_rounding[NAME]``, of tips that no condition of a study has.

    Parameters
    ----------
    study
        Its file.
    tips
        Those that conditions name.

    Raises
    ------
    InputError
        For the first tip that is unknown.
    """
    sections: dict[str, Iterable[str]] = {
        "diagnosis.mechanisms": study.diagnosis.mechanisms,
        "diagnosis.ranges": study.diagnosis.ranges,
        **{f"laboratory.{name}.mechanisms": each.mechanisms for name, each in study.laboratory.items()},
    }
    for place, keys in sections.items():
        for key in keys:
            tip = MECHANISMS[key].tip if key in MECHANISMS else ""
            if tip and tip not in tips:
                raise InputError(
                    f"{key}: no condition has a tip of this name{suggestion(tip, tips)}",
                    remedy=f"use one of: {', '.join(tips)}"
                    if tips
                    else "leave the brackets out: the study has one tip",
                    place=place,
                )
