"""Units of time, load and depth: those that a user gives, or that a table states beside the names of its columns."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from palpate.errors import InputError

CHANNELS = {"time": "s", "load": "mN", "depth": "nm"}
SCALES = {
    "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "load": {"mN": 1.0, "uN": 1e-3, "nN": 1e-6, "N": 1e3},
    "depth": {"nm": 1.0, "um": 1e3, "mm": 1e6, "m": 1e9, "A": 0.1},
}
BRACKETED = re.compile(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]")
APPENDED = re.compile(r"(?:\s/\s*|/|_(?=\w\w))(\w+)$")


def plain(unit: str) -> str:
    """Return a unit in letters that every keyboard has: ``um`` for either of Unicode's micro signs."""
    return unicodedata.normalize("NFKC", unit).strip().translate(str.maketrans("μÅ", "uA"))


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
    return f"turn it (`palpate read --columns ... --units {key}=-{CHANNELS[key]}`)"


def stated(key: str, heading: str | None, below: Sequence[str]) -> str | None:
    """Return the unit that a column states before its numbers, or None.

    ``Load (uN)``, ``Load [uN]``, ``P / uN`` and ``load_uN`` state it, and ``uN`` alone in a row `below` the heading.
    One letter behind an underscore is part of a name, as in ``F_N``; so is one alone where the heading is not known.

    Parameters
    ----------
    heading
        The name in the table's header; None where the column is known by its number alone.
    below
        Cells under the header, or above the numbers where no header is known.

    Raises
    ------
    InputError
        When a unit in brackets or below a heading is not known.
    """
    texts = [plain(text) for text in below if re.search(r"[^\W\d_]", text)]
    named = texts if heading is None else [plain(heading)]
    bracketed = [unit for text in named for unit in BRACKETED.findall(text)]
    alone = [text.strip("()[] ") for text in texts if heading is not None or len(text) > 1]
    for unit in (*alone, *bracketed, *(unit for text in named for unit in APPENDED.findall(text))):
        if unit in SCALES[key]:
            return unit
    if heading is not None and (alone or bracketed):
        raise InputError(
            f"the {key}'s unit {(*alone, *bracketed)[0]!r} is not known",
            remedy=f"state it by --units {key}=UNIT (in a study by source.units), one of: {', '.join(SCALES[key])}",
            place=f"column {heading}",
        )
    return None
