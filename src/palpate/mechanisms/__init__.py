"""Mechanisms of missing physics: every module of this folder that defines ``MECHANISM`` is found by itself."""

from collections.abc import Iterable, Mapping
from typing import Any

from indentation_files.discovery import discover
from palpate.errors import InputError, part_of
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.mechanism import Mechanism, Range, Scale

MECHANISMS: dict[str, Mechanism] = {found.key: found for found in discover(__name__, __path__, "MECHANISM")}


def known(keys: Iterable[str], place: str) -> dict[str, Mechanism]:
    """Return the mechanisms of some keys in their order; raises `InputError` at `place` for one that there is not."""
    found = {}
    for key in keys:
        if key not in MECHANISMS:
            raise InputError(
                f"mechanism {key!r} is not known", remedy=f"use one of: {', '.join(MECHANISMS)}", place=place
            )
        found[key] = MECHANISMS[key]
    return found


def considered(named: Iterable[str], place: str) -> dict[str, Mechanism]:
    """Return the mechanisms that a study names at `place`; those that count by default where it names none."""
    every = {key: mechanism for key, mechanism in MECHANISMS.items() if mechanism.by_default}
    return known(named, place) or every


def breaking(*assumptions: Assumption) -> tuple[str, ...]:
    """Return the keys of the mechanisms that break any of some assumptions of an exact law."""
    return tuple(key for key, mechanism in MECHANISMS.items() if mechanism.breaks.intersection(assumptions))


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
    for key, mechanism in known(given, "mechanisms").items():
        with part_of(f"mechanisms.{key}"):
            checked[key] = mechanism.check({} if given[key] is None else given[key])
    return checked


__all__ = [
    "MECHANISMS",
    "Assumption",
    "Mechanism",
    "Range",
    "Scale",
    "breaking",
    "checked_mechanisms",
    "considered",
    "known",
]
