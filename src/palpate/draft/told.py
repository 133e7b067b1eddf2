"""What files say of tip and sample: taken where all say it alike, else told with the reason why it is not taken."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from palpate.draft.solid import POISSON_RATIO
from palpate.errors import InputError
from palpate.indenters import Indenter
from palpate.readers.text import number
from palpate.stated import COEFFICIENTS, Stated

OF_SAMPLE = re.compile(r"(?!.*(indenter|tip|probe|diamond)).*poisson['’]?s? ratio", re.IGNORECASE)
BERKOVICH, NEAR = 24.5, 0.05
Said = Sequence[tuple[str, Mapping[str, Any]]]


def stated_by(metadata: Sequence[Mapping[str, Any]]) -> Stated:
    """Return what the metadata of tests agree on, by whatever name they give the sample's Poisson's ratio."""
    return Stated.by_all([{**each, "Poisson's ratio": _poisson_ratio(each)} for each in metadata])


def not_taken(tests: Said, stated: Stated, radius: float | None) -> list[str]:
    """Return one remark for each of tip and Poisson's ratio that is stated and not taken.

    Parameters
    ----------
    tests
        Name and metadata of each.
    stated
        What was taken, by `stated_by`.
    radius
        Of a sphere that was given [nm]; nothing is said of the files' tips then.
    """
    remarks = []
    if stated.poisson_ratio is None:
        said = {name: _poisson_ratio(each) for name, each in tests}
        remarks += _remark("Poisson's ratio", said, "it is not above 0 and below 0.5", f"{POISSON_RATIO} is guessed")
    if not stated.area and radius is None:
        tips = {name: _coefficients(each) for name, each in tests}
        if not all(_ideal(tip) for tip in tips.values()):
            shown = {name: ", ".join(f"{value:g}" for value in tip) for name, tip in tips.items()}
            reason = _no_tip(next(iter(tips.values())))
            remarks += _remark("the tip's area function", shown, reason, "a Berkovich tip is guessed")
    return remarks


def _remark(what: str, said: Mapping[str, str], reason: str, instead: str) -> list[str]:
    """Return what tests say, each value with the first test that says it; nothing where none says anything."""
    tests_of: dict[str, list[str]] = {}
    for name, value in said.items():
        tests_of.setdefault(value, []).append(name)
    if not any(tests_of):
        return []
    if len(tests_of) == 1:
        return [f"{what} is stated as {next(iter(tests_of))} and not taken, as {reason}; {instead}"]
    shown = []
    for value, names in tests_of.items():
        others = f" and {len(names) - 1} more" if len(names) > 1 else ""
        shown.append(f"{value or 'nothing'} by {names[0]}{others}")
    return [f"{what} is stated unlike and not taken: {'; '.join(shown)}; {instead}"]


def _poisson_ratio(metadata: Mapping[str, Any]) -> str:
    """Return the number that a file states as its sample's Poisson's ratio, empty where it states none."""
    said = [_number(value) for name, value in metadata.items() if OF_SAMPLE.match(name)]
    return next((f"{value:g}" for value in said if value is not None), "")


def _coefficients(metadata: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the coefficients of an area function as a file states them, without zeros at the end."""
    for name, first in COEFFICIENTS.items():
        area: list[float] = []
        while (value := _number(metadata.get(name.format(first + len(area))))) is not None:
            area.append(value)
        while area and area[-1] == 0.0:
            area.pop()
        if area:
            return tuple(area)
    return ()


def _ideal(area: tuple[float, ...]) -> bool:
    """Return whether no tip is stated, or the ideal Berkovich tip that is taken anyway."""
    return not area or (len(area) == 1 and math.isclose(area[0], BERKOVICH, rel_tol=NEAR))


def _no_tip(area: tuple[float, ...]) -> str:
    """Return why an area function cannot be taken."""
    try:
        Indenter.from_mapping({"shape": "area_function", "area": list(area)})
    except InputError as error:
        return error.problem
    return f"a single coefficient other than {BERKOVICH} is an ideal tip that is no Berkovich's"


def _number(said: object) -> float | None:
    """Return the number with which an entry begins, before its unit; None where there is none."""
    try:
        value = number(str(said).split()[0])
    except (ValueError, IndexError):
        return None
    return value if math.isfinite(value) else None
