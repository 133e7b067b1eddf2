"""Units that a table states in words: beside the name of a column, or in a row of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence

from indentation_files.errors import InputError
from indentation_files.readers.decimals import MISSING
from indentation_files.readers.units import CHANNELS, PREFIX, SCALES, plain, unit_of

BRACKETS = "()[]{}<> "
BRACKETED = re.compile(r"[(\[{<]\s*([^()\[\]{}<>]+?)\s*[)\]}>]")
LETTERS = re.compile(r"(?<![^\W_])[^\W\d_]+(?![^\W_])")
LIKE_A_UNIT = re.compile(
    r"V|cm|MN|[pnumk][NgmsV]|[numkMG]?(?:gf|lbf?|Pa)"
    r"|(?i:[mun]?sec|(?:milli|micro|nano)?(?:newton|met(?:er|re)|micron|angstr[oö]m|minute|hour|gram|volt|inch)(?:e?s)?"
    r"|(?:milli|micro|nano)?seconds)"
)
# Powers before a bracket or at the end of one or of the heading: ``10^-3 [N]``, ``1e-3 (N)``; what multiplies or
# divides the name or the unit: ``1000*Load (mN)``, ``[N] x1000``, ``(mN)/1000``.
FACTOR = re.compile(
    r"(?:10 ?(?:\^|\*\*) ?[-+−]?\d+|10[⁻⁺]?[⁰¹²³⁴-⁹]+|\d[eE][-+]\d+|[x×*] ?10+)(?= ?[*·×]? ?(?:[()\[\]{}<>]|$))"
    r"|^\d+(?:[.,]\d+)? ?[*·×] ?(?=[^\W\d_])"
    r"|(?<![^\W_])(?:[*·×/]|[x](?= ?\d)) ?\d+(?:[.,]\d+)?(?![^\W_])"
)
SPELT_OUT = re.compile(r"(?<![^\W_])(milli|micro|nano|pico|kilo)[ _-]([Nms])(?![^\W_])", re.IGNORECASE)
CAMEL = re.compile(r"(?<=[a-z]{2})(?=[A-Z])")
OF_UNITS = re.compile(r"(?<![^\W_])(?:units?|einheit(?:en)?|unit[ée]s?|unidad(?:es)?)(?![^\W_])", re.IGNORECASE)
CHANNEL_WORDS = {
    "time": {"time", "zeit", "temps", "t"},
    "load": {"load", "force", "kraft", "fn", "p", "f"},
    "depth": {"depth", "displacement", "disp", "indentation", "penetration", "eindringtiefe", "pd", "h"},
}
QUALIFIERS = {  # words beside these that leave no doubt which time, load or depth is meant
    "time": {"test", "elapsed"},
    "load": {"on", "sample", "normal"},
    "depth": {"into", "surface", "indenter", "indent"},
}


def unmistakable(heading: str, below: str) -> str | None:
    """Return the channel that a heading names with its unit and nothing besides; None for any other.

    ``Load On Sample (mN)`` and ``h / nm`` name one, and so does ``Depth`` with ``nm`` alone in the cell `below`;
    ``Piezo displacement (nm)`` and ``Force`` name none.
    """
    key = channel_of(heading)
    if key is None:
        return None
    try:
        unit = stated(key, heading, heading, [below] if unit_of(key, plain(below).strip(BRACKETS)) else [])
    except InputError:
        return None
    words = {word for word in words_in(heading) if unit_of(key, word) is None or word in CHANNEL_WORDS[key]}
    return key if unit and words <= CHANNEL_WORDS[key] | QUALIFIERS[key] else None


def channel_of(heading: str) -> str | None:
    """Return the channel whose name a heading holds, such as ``load`` for ``Load On Sample``; None for any other."""
    return next((key for key, known in CHANNEL_WORDS.items() if words_in(heading) & known), None)


def words_in(heading: str) -> set[str]:
    """Return the words of a heading in small letters, without units in brackets."""
    return {word.casefold() for word in LETTERS.findall(BRACKETED.sub(" ", plain(heading)))}


def in_prose(line: str) -> dict[str, str]:
    """Return the units that a line beside a table states in words: ``Load unit: uN``, ``time in s, depth in um``.

    It must speak of units, or of more than one channel. A unit belongs to the channel named before it.
    """
    found: dict[str, str] = {}
    key = None
    for word in LETTERS.findall(plain(line)):
        key = next((k for k, known in CHANNEL_WORDS.items() if len(word) > 1 and word.casefold() in known), key)
        unit = key and unit_of(key, word)
        if key and unit and (len(word) > 1 or word == CHANNELS[key]):
            found.setdefault(key, unit)
    return found if len(found) > 1 or OF_UNITS.search(line) else {}


def is_word(cell: str) -> bool:
    """Return whether a cell is text, neither a number nor the sign of a missing one."""
    return LETTERS.search(cell) is not None and cell.lower() not in MISSING


def is_row_of_units(cells: Sequence[str]) -> bool:
    """Return whether at least two of the cells for time, load and depth (in this order) are units and nothing else."""
    units = [plain(cell).strip(BRACKETS) for cell in cells]
    known = [unit_of(key, unit) or LIKE_A_UNIT.fullmatch(unit) for key, unit in zip(CHANNELS, units, strict=True)]
    return sum(map(bool, known)) >= 2


def stated(key: str, column: str, heading: str, alone: Sequence[str]) -> str | None:
    """Return the unit that the table states for a column, or None where it says nothing of any.

    What is in brackets, behind a slash or comma or alone in a cell is a unit: ``Load (uN)``, ``P / uN``, ``P, N``.
    Without these, a word of the heading that is one counts: ``sample_load_uN``, ``Load in uN``, ``load_micro_N``. A
    single letter in it may also belong to the name, as in ``F_N``.

    The `key` is ``time``, ``load`` or ``depth``, `column` what the user calls the column, for messages, and `heading`
    its name in the table; empty where the table names none. Other texts about the column stand `alone`: cells of rows
    of units and of remarks. Raises `InputError` when the unit is not known or has a factor, may be part of the name, or
    is stated twice and differently.
    """
    texts = [plain(text) for text in (*alone, heading)]
    texts = [SPELT_OUT.sub(lambda found: PREFIX[found[1].casefold()] + found[2], text) for text in texts]
    bracketed = [unit for text in texts for unit in BRACKETED.findall(text)]
    name, *behind = re.split(r"/(?!.*/)", BRACKETED.sub(" ", texts.pop()))
    behind += [part for part in name.split(",")[1:] if unit_of(key, part)]
    marked = [unit.strip(BRACKETS) for unit in (*texts, *bracketed, *behind) if unit.strip(BRACKETS)]
    words = [part for word in LETTERS.findall(name) for part in ([word] if unit_of(key, word) else CAMEL.split(word))]
    units = [unit for text in marked if (unit := unit_of(key, text))]
    if not units:
        units = [unit for word in words if (unit := unit_of(key, word)) and (len(word) > 1 or word == CHANNELS[key])]
    factor = FACTOR.search(heading.strip())
    if factor:
        units, marked = [], [factor[0]]
    doubtful = marked or [word for word in words if unit_of(key, word) or LIKE_A_UNIT.fullmatch(word)]
    if len(set(units)) == 1:
        return units[0]
    if not units and not doubtful:
        return None
    if units:
        problem = f"the {key}'s unit is stated as {' and '.join(dict.fromkeys(units))}"
    elif unit_of(key, doubtful[0]):
        problem = f"{doubtful[0]!r} may be the {key}'s unit or part of the name"
    else:
        problem = f"the {key}'s unit {doubtful[0]!r} is not known"
    remedy = f"state it by --units {key}=UNIT (in a study by source.units), one of: {', '.join(SCALES[key])}"
    raise InputError(problem, remedy=remedy, place=f"column {column}")
