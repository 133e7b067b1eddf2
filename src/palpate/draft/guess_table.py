"""Everything that a draft takes or guesses, one row each with its reason: in the study and on the screen."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from palpate.draft.known_tip import FILES, KnownTip
from palpate.draft.prescribed_drive import Drive
from palpate.draft.solid import OF_GELS, Solid
from palpate.draft.stated import hardness, plane_strain_modulus, youngs_modulus
from palpate.materials import law_of
from palpate.materials.first_guess import Guessed

WIDEST = 40  # letters of a value


class Guess(NamedTuple):
    """One thing that a draft takes or guesses."""

    what: str
    value: str
    why: str


def guess_table(
    law: tuple[str, str],
    tip: KnownTip,
    drive: Drive,
    ratio: tuple[float, bool],
    guessed: Mapping[str, Guessed],
) -> list[Guess]:
    """Return what a draft takes or guesses.

    Parameters
    ----------
    law
        Its key, or how recordings choose it, and why.
    tip, drive
        What the files state, or the tests show.
    ratio
        Poisson's, and whether the files state it.
    guessed
        Ranges of its parameters, and why.
    """
    units = {parameter.name: parameter.unit for parameter in law_of(law[0]).declared({})} if guessed else {}
    rows = [Guess("law", *law), Guess("drive", drive.control, drive.why), Guess("tip", _tip(tip), tip.why)]
    if "modulus" in tip.keys:
        rows.append(Guess("tip's modulus", f"{tip.keys['modulus']:g} GPa", "guess: diamond, as the solid is stiff"))
    rows.append(Guess("Poisson's ratio", f"{ratio[0]:g}", FILES if ratio[1] else _guessed_ratio(ratio[0])))
    for name, (values, why) in guessed.items():
        shown = " to ".join(f"{value:.4g}" for value in values)
        rows.append(Guess(name, f"{shown} {'' if units[name] == '-' else units[name]}".strip(), f"guess: {why}"))
    return rows


def _guessed_ratio(ratio: float) -> str:
    return "guess: gels and rubbers hardly change their volume" if ratio == OF_GELS else "guess"


def evaluated(solid: Solid, facts: Sequence[Mapping[str, Any]], ratio: float) -> list[Guess]:
    """Return modulus and hardness by unloading, ours beside the vendor's own, medians of the tests.

    Where files state a plane-strain modulus alone, Young's follows from it with a Poisson's `ratio`.
    """
    moduli, in_plane_strain = _known(map(youngs_modulus, facts)), _known(map(plane_strain_modulus, facts))
    vendor = _median(moduli)
    if in_plane_strain and not moduli:
        young = float(np.median(in_plane_strain)) * (1.0 - ratio**2)
        vendor = f"{_median(in_plane_strain)} for E/(1 - nu^2), {young:.4g} GPa with a Poisson's ratio of {ratio:g}"
    rows = [("modulus", solid.modulus, vendor), ("hardness", solid.hardness, _median(_known(map(hardness, facts))))]
    return [
        Guess(
            f"{what} by unloading",
            "no unloading determines it" if math.isnan(ours) else f"{ours:.4g} GPa",
            f"the files state {theirs or 'none'}",
        )
        for what, ours, theirs in rows
        if theirs or not math.isnan(ours)
    ]


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _median(values: Sequence[float]) -> str:
    """Return the median [GPa] of what tests state in words; empty where none states it."""
    if not values:
        return ""
    return f"{float(np.median(values)):.4g} GPa{f' (median of {len(values)} tests)' if len(values) > 1 else ''}"


def lines(rows: Sequence[Guess]) -> list[str]:
    """Return the rows as a table of text."""
    widths = [max(len(row[k][:WIDEST]) for row in rows) for k in (0, 1)]
    return [f"  {row.what:<{widths[0]}}  {_brief(row.value):<{widths[1]}}  {row.why}" for row in rows]


def _brief(text: str) -> str:
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}..."


def _tip(tip: KnownTip) -> str:
    keys = {key: value for key, value in tip.keys.items() if key not in ("shape", "modulus", "poisson_ratio")}
    shown = (
        ", ".join(f"{v:.4g}" for v in value) if isinstance(value, list) else f"{value:g}" for value in keys.values()
    )
    return f"{tip.keys['shape']} {', '.join(shown)}"
