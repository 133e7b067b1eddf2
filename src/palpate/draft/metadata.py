"""What files state of tip and sample: taken where all agree, else reported with the reason why it is not taken."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from palpate.base.sentences import and_more
from palpate.draft.known_tip import KnownTip, unusable
from palpate.draft.solid import POISSON_RATIO
from palpate.draft.stated import Stated, area_share, coefficients, of_instrument, poisson_ratio, radius_entry
from palpate.study.area_function import BERKOVICH

NEAR = 0.05  # relative difference from the ideal tip's coefficient, within which a stated one is that
NEAR_AREA = 1.25  # chosen: ratio to the ideal tip's area that a real Berkovich tip has at some depth
NamedMetadata = Sequence[tuple[str, Mapping[str, Any]]]


def not_taken(
    tests: NamedMetadata, stated: Stated, tip: KnownTip, deepest: float = 0.0, ratio: float = POISSON_RATIO
) -> list[str]:
    """Return one remark for each of tip and Poisson's ratio that is stated and not taken.

    Parameters
    ----------
    tests
        Name and metadata of each.
    stated
        What was taken.
    tip
        That is used; no message is given on the files' tips where one was given.
    deepest
        Largest depth of the tests [nm].
    ratio
        Poisson's, that is guessed where none is taken.
    """
    remarks = []
    if stated.poisson_ratio is None:
        ratios = {name: poisson_ratio(each) for name, each in tests}
        stated_ratios = {name: "" if ratio is None else f"{ratio:g}" for name, ratio in ratios.items()}
        remarks += _remark("Poisson's ratio", stated_ratios, "it is not above 0 and below 0.5", f"{ratio:g} is guessed")
    if tip.why.startswith("guess"):
        tips = {name: coefficients(each) for name, each in tests}
        if not all(_ideal(area) for area in tips.values()):
            shown = {name: ", ".join(f"{value:g}" for value in area) for name, area in tips.items()}
            reason = _no_tip(next(iter(tips.values())), deepest)
            remarks += _remark("the tip's area function", shown, reason, "a Berkovich tip is guessed")
        radii = {name: radius_entry(each) for name, each in tests}
        remarks += _remark("the tip's radius", radii, "it is no length above zero", "a Berkovich tip is guessed")
        shares = {name: area_share(each) for name, each in tests}
        if any(share and not 1.0 / NEAR_AREA < share / BERKOVICH < NEAR_AREA for share in shares.values()):
            shown = {
                name: f"{share:.3g} times the square of its depth" if share else "" for name, share in shares.items()
            }
            remarks += _remark(
                "the contact area", shown, f"it is {BERKOVICH} times for a Berkovich tip", "a Berkovich tip is guessed"
            )
        if stated.shape and stated.shape not in ("berkovich", "vickers"):
            remarks.append(
                f"the files state a tip of the shape {stated.shape}, without what it takes to simulate it; a Berkovich "
                "tip is guessed (give --sphere, or correct the indenter in the study)"
            )
    return remarks


def of_the_instrument(tests: NamedMetadata) -> list[str]:
    """Return one remark with what files state of frame, drift and temperature."""
    entries = of_instrument(tests[0][1])
    if not entries:
        return []
    differ = any(of_instrument(each) != entries for _, each in tests)
    which = f"{tests[0][0]} states" if differ and len(tests) > 1 else "the files state"
    return [f"{which}: {', '.join(entries)}; each recording states which corrections its depth contains"]


def _remark(what: str, entries: Mapping[str, str], reason: str, instead: str) -> list[str]:
    """Return what tests state, each value with the first test that states it; nothing where none states anything."""
    tests_of: dict[str, list[str]] = {}
    for name, value in entries.items():
        tests_of.setdefault(value, []).append(name)
    if not any(tests_of):
        return []
    if len(tests_of) == 1:
        return [f"{what} is stated as {next(iter(tests_of))} and not taken, as {reason}; {instead}"]
    shown = []
    for value, names in tests_of.items():
        shown.append(f"{value or 'nothing'} by {names[0]}{and_more(names)}")
    return [f"{what} differs between the files and is not taken: {'; '.join(shown)}; {instead}"]


def _ideal(area: tuple[float, ...]) -> bool:
    """Return whether no tip is stated, or the ideal Berkovich tip that is taken anyway."""
    return not area or (len(area) == 1 and math.isclose(area[0], BERKOVICH, rel_tol=NEAR))


def _no_tip(area: tuple[float, ...], deepest: float) -> str:
    """Return why an area function cannot be taken."""
    ideal = f"a single coefficient other than {BERKOVICH} is an ideal tip that is no Berkovich's"
    return ideal if len(area) == 1 else unusable(area, deepest)
