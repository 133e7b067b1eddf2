"""Mechanisms of missing physics: every module of this folder that defines ``MECHANISM`` is found by itself."""

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from indentation_files.discovery import discover
from palpate.base.parameters import in_words
from palpate.errors import InputError, part_of
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.mechanism import Mechanism, Range, Scale

OF_NAMED_TIP = re.compile(r"(\w+)\[([\w-]+)\]")


class Library(dict[str, Mechanism]):
    """Mechanisms by their keys. Those of the tip have keys ``KEY[NAME]``, too, for a tip that a study calls NAME."""

    def __missing__(self, key: str) -> Mechanism:
        """Return a mechanism of a named tip; raises `KeyError`."""
        return _of_named_tip(key)

    def __contains__(self, key: object) -> bool:
        """Return whether there is a mechanism of this key."""
        try:
            return isinstance(key, str) and bool(self[key])
        except KeyError:
            return False


MECHANISMS = Library({found.key: found for found in discover(__name__, __path__, "MECHANISM")})


@cache
def _of_named_tip(key: str) -> Mechanism:
    found = OF_NAMED_TIP.fullmatch(key)
    if found is None or found[1] not in [*MECHANISMS] or not MECHANISMS[found[1]].of_the_tip:
        raise KeyError(key)
    return MECHANISMS[found[1]].of_tip(found[2])


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


def considered(named: Iterable[str], place: str, tips: Iterable[str] = ()) -> dict[str, Mechanism]:
    """Return the mechanisms that a study names at `place`; those that count by default where it names none.

    These hold those of the tip once for each of the study's named `tips`, too.
    """
    every = {key: mechanism for key, mechanism in MECHANISMS.items() if mechanism.by_default}
    of_tips = [f"{key}[{tip}]" for tip in tips for key, mechanism in every.items() if mechanism.of_the_tip]
    return known(named, place) or every | {key: MECHANISMS[key] for key in of_tips}


def quantity_in_words(name: str) -> str:
    """Return the name of a material parameter, or of a mechanism's (``key.name``), as people write it."""
    if "." not in name:
        return in_words(name)
    key, own = name.split(".")
    title, words = MECHANISMS[key].title, in_words(own)
    return title if title.endswith(words) else f"{title}, {words}"


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
