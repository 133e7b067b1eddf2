"""Mechanisms of missing physics: every module of this folder that defines ``MECHANISM`` is found by itself."""

from collections.abc import Mapping
from typing import Any

from palpate.base.discovery import discover
from palpate.errors import InputError
from palpate.mechanisms.mechanism import Mechanism, Range, Scale

MECHANISMS: dict[str, Mechanism] = {found.key: found for found in discover(__name__, __path__, "MECHANISM")}


def checked_mechanisms(given: Any) -> dict[str, dict[str, float]]:
    """Return what a file gives under ``mechanisms``, each with all of its parameters; nothing given is none.

    Raises
    ------
    InputError
        With its place, for the first mechanism or parameter that is not known, missing or out of range.
    """
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise InputError("mechanisms is not a table of keys", remedy="give key: {parameter: value}", place="mechanisms")
    checked = {}
    for key, values in given.items():
        if key not in MECHANISMS:
            raise InputError(
                f"mechanism {key!r} is not known", remedy=f"use one of: {', '.join(MECHANISMS)}", place="mechanisms"
            )
        try:
            checked[key] = MECHANISMS[key].check({} if values is None else values)
        except InputError as error:
            place = ".".join(filter(None, ("mechanisms", key, error.place)))
            raise InputError(error.problem, remedy=error.remedy, place=place) from None
    return checked


__all__ = ["MECHANISMS", "Mechanism", "Range", "Scale", "checked_mechanisms"]
