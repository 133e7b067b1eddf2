"""Units of time, load and depth, and what they are in s, mN and nm; how else they are spelled.

The gram-force is 9.80665 mN exactly: a gram under the standard gravity of 9.80665 m/s^2 (3rd CGPM, 1901). The
pound-force is that of 0.45359237 kg.
"""

from __future__ import annotations

import re
import unicodedata

from indentation_files.errors import InputError

CHANNELS = {"time": "s", "load": "mN", "depth": "nm"}
SCALES = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0, "d": 86400.0},
    "load": {
        "mN": 1.0, "uN": 1e-3, "nN": 1e-6, "pN": 1e-9, "cN": 10.0, "N": 1e3, "gf": 9.80665, "mgf": 9.80665e-3,
        "kgf": 9806.65, "dyne": 1e-2, "lbf": 4448.2216152605, "kN": 1e6, "daN": 1e4,
    },
    "depth": {"nm": 1.0, "um": 1e3, "mm": 1e6, "cm": 1e7, "m": 1e9, "A": 0.1, "pm": 1e-3, "inch": 2.54e7},
}  # fmt: skip
STIFFNESS = {"N/m": 1.0}
SPELLED = {
    "time": {
        "second": "s", "seconde": "s", "sekunde": "s", "sekunden": "s", "sec": "s", "sek": "s", "minute": "min",
        "minuten": "min", "min": "min", "hour": "h", "heure": "h", "stunde": "h", "stunden": "h", "hr": "h", "day": "d",
        "segundo": "s", "secondo": "s", "secondi": "s", "minuto": "min", "minuti": "min", "с": "s", "сек": "s",
        "мин": "min", "ч": "h",
    },
    "load": {
        "newton": "N", "lb": "lbf", "dyn": "dyne", "gramforce": "gf", "gforce": "gf", "gf": "gf", "н": "N", "гс": "gf",
    },
    "depth": {
        "meter": "m", "metre": "m", "metro": "m", "metri": "m", "micron": "um", "angstrom": "A", "ang": "A", "м": "m",
    },
}  # fmt: skip
PREFIX = {
    "milli": "m", "micro": "u", "mikro": "u", "nano": "n", "pico": "p", "piko": "p", "centi": "c", "zenti": "c",
    "kilo": "k", "mili": "m", "m": "m", "u": "u", "k": "k", "м": "m", "мк": "u", "н": "n", "к": "k",
}  # fmt: skip
CAPITALS_OF_TWO = {"load": {"MN", "МН"}}  # meganewton: capitals do not distinguish it from the millinewton
BRACKETS = {  # as wide as a letter, read as Latin-1: Shift-JIS, GBK and EUC-KR, Big5
    "\x81i": "(", "\x81j": ")", "\x81m": "[", "\x81n": "]", "£¨": "(", "£©": ")", "£Û": "[", "£Ý": "]", "¡]": "(",
    "¡^": ")",
}  # fmt: skip
MICRO = ("Âµ", "Î¼", "¦Ì", "\x83Ê", "£g", "¥ì")  # read as Latin-1: UTF-8, UTF-8 (Greek), GBK, Shift-JIS, Big5, EUC-KR
PLAIN = {**dict.fromkeys(MICRO, "u"), **BRACKETS}
TORN = re.compile("[ÂÃÎ][\x80-\xbf]")  # two bytes that begin as those of µ, ² or °, of ü, and of the Greek mu


def plain(unit: str) -> str:
    """Return a unit in letters that every keyboard has: ``um`` for either of Unicode's micro signs.

    So it is where the sign was written in another encoding than it was read in, as Chinese and Japanese programs do.
    Brackets as wide as their letters are treated alike.
    """
    for spelling, meant in PLAIN.items():
        unit = unit.replace(spelling, meant)
    return unicodedata.normalize("NFKC", unit).strip().translate(str.maketrans("μÅ【】〔〕", "uA[][]"))


def mended(text: str) -> str:
    """Return text in which UTF-8 was read as Latin-1, such as ``Âµm`` or ``PrÃ¼fung``, as it was meant."""
    return TORN.sub(lambda torn: torn[0].encode("latin-1").decode("utf-8"), text)


def unit_of(key: str, text: str) -> str | None:
    """Return the unit of `SCALES` that a text means for a channel, or None for another text.

    ``Sec``, ``sec.``, ``secs`` and ``SECONDS`` are s, ``microns`` is um, ``Grams-Force`` is gf, ``UN`` is uN, ``мкм``
    is um. Accents do not count. Capitals that are two units, ``MN``, are none.
    """
    known, name = SCALES[key], plain(text).rstrip(".").rstrip()
    if name in known:
        return name
    if name in CAPITALS_OF_TWO.get(key, ()):
        return None
    folded = re.sub(r"[\s\u0300-\u036f-]", "", unicodedata.normalize("NFD", name.casefold()))
    for unit in known:
        if unit.casefold() == folded and (len(unit) > 1 or unit == CHANNELS[key]):
            return unit
    for singular in (folded, folded.removesuffix("s"), folded.replace("gramsforce", "gramforce")):
        for word, unit in SPELLED[key].items():
            prefix = singular.removesuffix(word)
            scaled = PREFIX.get(prefix, prefix) + unit if singular.endswith(word) else ""
            if scaled in known:
                return scaled
    return None


def scale(key: str, unit: str) -> float:
    """Return the factor that brings a channel from `unit` to s, mN or nm; ``-mN`` turns the sign.

    Raises `InputError` when the unit is not known.
    """
    name = plain(unit)
    found = unit_of(key, name.removeprefix("-"))
    if found is None:
        known = ", ".join(SCALES[key])
        raise InputError(f"{key} in {unit!r} is not known", remedy=f"use one of: {known}", place="units")
    return -SCALES[key][found] if name.startswith("-") else SCALES[key][found]


def to_turn(key: str) -> str:
    """Return the remedy where a channel has the wrong sign."""
    return (
        f"turn it (`palpate read --columns ... --units {key}=-{CHANNELS[key]}`, with the file's unit after the minus)"
    )
