"""The tips of a study: its own, and those that conditions name under ``indenter``.

One condition describes a tip of its own in full, others name it. All tips press the same material on the same
instrument; what belongs to a tip alone, such as its rounding, is named after it, ``tip_rounding[NAME].radius``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from palpate.configuration.schema import suggestion
from palpate.errors import InputError, part_of
from palpate.mechanisms import MECHANISMS
from palpate.study.indenter import Indenter

DESCRIBE = "describe it at one condition, {name: NAME, shape: SHAPE, ...}, or name one that is described"


def indenters_of(values: Mapping[str, Any]) -> tuple[Indenter, dict[str, Indenter]]:
    """Return the tip of a study, and those that its conditions describe, by their names.

    Parameters
    ----------
    values
        Keys of the study.

    Raises
    ------
    InputError
        When a tip is none, is described in two ways or nowhere, or every condition has one of its own.
    """
    with part_of("indenter"):
        own = _indenter(values["indenter"])
    entries: Sequence[Mapping[str, Any]] = values["conditions"]
    found: dict[str, Indenter] = {}
    for k, entry in enumerate(entries):
        given = entry.get("indenter")
        if not isinstance(given, Mapping):
            continue
        with part_of(f"conditions[{k}] ({entry['name']}).indenter"):
            name = given["name"]
            tip = _indenter({key: value for key, value in given.items() if key != "name"})
            if found.setdefault(name, tip) != tip:
                raise InputError(
                    f"another tip is called {name!r}, too", remedy="rename one, or describe it once", place="name"
                )
    for k, entry in enumerate(entries):
        name = tip_name(entry)
        if name and name not in found:
            raise InputError(
                f"tip {name!r} is described nowhere{suggestion(name, found)}",
                remedy=DESCRIBE,
                place=f"conditions[{k}] ({entry['name']}).indenter",
            )
    if all(map(tip_name, entries)):
        raise InputError(
            "no condition is tested with this tip",
            remedy="make one of the conditions' tips the study's, and leave it out there",
            place="indenter",
        )
    return own, found


def tip_name(entry: Mapping[str, Any]) -> str:
    """Return the name of the tip of a condition's own; empty for the study's."""
    given = entry.get("indenter", "")
    return str(given["name"] if isinstance(given, Mapping) else given)


def _indenter(given: Mapping[str, Any]) -> Indenter:
    """Return an indenter; raises `InputError` with the place within it."""
    if "poisson_ratio" in given and "modulus" not in given:
        raise InputError(
            "a rigid tip has no Poisson's ratio", remedy="add its modulus, or leave it out", place="poisson_ratio"
        )
    return Indenter.from_mapping(given)


def check_tips(settings: Mapping[str, Any], tips: Mapping[str, Indenter]) -> None:
    """Refuse mechanisms, such as ``tip_rounding[NAME]``, of tips that no condition of a study has.

    Parameters
    ----------
    settings
        Of the study.
    tips
        Those that conditions name.

    Raises
    ------
    InputError
        For the first tip that is unknown.
    """
    diagnosis, laboratories = settings["diagnosis"], settings.get("laboratory", {})
    sections = {
        "diagnosis.mechanisms": diagnosis["mechanisms"],
        "diagnosis.ranges": diagnosis["ranges"],
        **{f"laboratory.{name}.mechanisms": each.get("mechanisms") or () for name, each in laboratories.items()},
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
