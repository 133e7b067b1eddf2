"""Units of time, load and depth, and what they are in s, mN and nm."""

from __future__ import annotations

import re
import unicodedata

from palpate.errors import InputError

CHANNELS = {"time": "s", "load": "mN", "depth": "nm"}
SCALES = {
    "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "load": {"mN": 1.0, "uN": 1e-3, "nN": 1e-6, "N": 1e3},
    "depth": {"nm": 1.0, "um": 1e3, "mm": 1e6, "m": 1e9, "A": 0.1},
}
STIFFNESS = {"N/m": 1.0}
MICRO = ("Âµ", "Î¼", "¦Ì", "\x83Ê", "£g", "¥ì")  # read as Latin-1: UTF-8, UTF-8 (Greek), GBK, Shift-JIS, Big5, EUC-KR
TORN = re.compile("[ÂÃÎ][\x80-\xbf]")  # two bytes that begin as those of µ, ² or °, of ü, and of the Greek mu


def plain(unit: str) -> str:
    """Return a unit in letters that every keyboard has: ``um`` for either of Unicode's micro signs.

    So it is where the sign was written in another encoding than it was read in, as Chinese and Japanese programs do.
    """
    for spelling in MICRO:
        unit = unit.replace(spelling, "u")
    return unicodedata.normalize("NFKC", unit).strip().translate(str.maketrans("μÅ", "uA"))


def mended(text: str) -> str:
    """Return text in which UTF-8 was read as Latin-1, such as ``Âµm`` or ``PrÃ¼fung``, as it was meant."""
    return TORN.sub(lambda torn: torn[0].encode("latin-1").decode("utf-8"), text)


def scale(key: str, unit: str) -> float:
    """Return the factor that brings a channel from `unit` to s, mN or nm; ``-mN`` turns the sign.

    Raises
    ------
    InputError
        When the unit is not known.
    """
    known = SCALES[key]
    name = plain(unit)
    if name.removeprefix("-") not in known:
        raise InputError(f"{key} in {unit!r} is not known", remedy=f"use one of: {', '.join(known)}", place="units")
    return -known[name[1:]] if name.startswith("-") else known[name]


def to_turn(key: str) -> str:
    """Return the remedy where a channel has the wrong sign."""
    return (
        f"turn it (`palpate read --columns ... --units {key}=-{CHANNELS[key]}`, with the file's unit after the minus)"
    )
