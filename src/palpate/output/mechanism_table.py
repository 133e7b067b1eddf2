"""The table of mechanisms in the documents, written from what each of them declares.

``python -m palpate.output.mechanism_table docs/study.md`` writes the table of a document anew.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from palpate.mechanisms import MECHANISMS, Mechanism, Range, Scale

HEAD = "| mechanism | effect on a recording | quantities of `ranges` | value | considered |\n|---|---|---|---|---|\n"
SCALE = Scale(depth=500.0, load=1.0, modulus=3.0, duration=60.0, loading_time=30.0, half_angle=70.3, pressure=0.1)


def table(mechanisms: Iterable[Mechanism]) -> str:
    """Return the table (Markdown), one row a mechanism."""
    return HEAD + "".join(f"{_row(mechanism)}\n" for mechanism in mechanisms)


def updated(text: str, mechanisms: Iterable[Mechanism]) -> str:
    """Return a document in which the table is as the mechanisms declare."""
    return re.sub(re.escape(HEAD) + r"(?:\|.*\n)*", lambda _: table(mechanisms), text)


def _row(mechanism: Mechanism) -> str:
    quantities = "; ".join(_quantity(mechanism, name, found) for name, found in mechanism.plausible(SCALE).items())
    value = "each recording's own" if mechanism.varies else "one for all"
    considered = "by default" if mechanism.by_default else "where it is named"
    return f"| `{mechanism.key}` | {mechanism.effect} | {quantities} | {value} | {considered} |"


def _quantity(mechanism: Mechanism, name: str, searched: Range) -> str:
    """Return a quantity with its unit, limits and meaning: a parameter's own, or those of its range."""
    own = next((p for p in mechanism.parameters if p.name == name), None)
    unit, meaning = (own.unit, own.meaning) if own else (searched.unit, searched.meaning)
    lower, upper = (own.lower, own.upper) if own else (searched.least, searched.largest)
    limits = f"{lower:g} to {upper:g}" if np.isfinite(upper) else f"from {lower:g}"
    return f"`{name}`{'' if unit == '-' else f' [{unit}]'}, {limits}: {meaning}"


if __name__ == "__main__":
    for file in map(Path, sys.argv[1:]):
        file.write_text(updated(file.read_text(encoding="utf-8"), MECHANISMS.values()), encoding="utf-8")
