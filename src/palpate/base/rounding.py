"""Numbers and units as people read them: an estimate is rounded by the width of its interval."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

SIGNIFICANT = 2  # digits of the width of an interval that are shown
ALONE = 3  # digits of a number without an interval
SKEWED = 5.0  # chosen: ratio of the upper end of an interval and its estimate, above which it spans decades
SMALL = 1e-3  # below it, numbers are written with a power of ten
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def rounded(value: float, digits: int = ALONE) -> str:
    """Return a number to so many significant digits, without an exponent from 0.001 to a million."""
    if not math.isfinite(value):
        return "-"
    if value and not SMALL <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return f"{mantissa} × 10{str(int(exponent)).translate(RAISED)}"
    return _to_place(value, _place(value, digits))


def interval(estimate: float, lower: float, upper: float) -> str:
    """Return an estimate with its 95 % interval, such as ``3.30 (3.22 to 3.40)``; of a constant the value alone.

    The width of the interval decides how many digits are shown. Of one that spans decades each value has its own, as in
    ``2.7 (0.015 to 110)``: the width is that of its upper end alone.
    """
    values = (estimate, lower, upper)
    width = upper - lower
    if not all(map(math.isfinite, values)) or width <= 0.0:
        return f"{float(f'{estimate:.4g}'):g}"
    if lower >= 0.0 and upper > SKEWED * estimate > 0.0:
        return "{} ({} to {})".format(*(rounded(value, SIGNIFICANT) for value in values))
    largest = max(map(abs, values))
    if largest < SMALL or largest >= 1e6:
        power = math.floor(math.log10(largest))
        inside = interval(*(value / 10.0**power for value in values))
        number, span = inside.split(" ", 1)
        return f"{number} {span} × 10{str(power).translate(RAISED)}"
    texts = [_to_place(value, _place(width, SIGNIFICANT)) for value in values]
    return f"{texts[0]} ({texts[1]} to {texts[2]})"


def interval_of(found: Mapping[Any, Any]) -> str:
    """Return `interval` of an entry of a result file, with ``estimate``, ``lower`` and ``upper``."""
    return interval(found["estimate"], found["lower"], found["upper"])


def _place(value: float, digits: int) -> int:
    """Return how many decimals show so many significant digits of a value; negative before the point."""
    return digits - 1 - math.floor(math.log10(abs(value))) if value else 0


def _to_place(value: float, place: int) -> str:
    """Return a value rounded to so many decimals; zero itself has no sign and no decimals."""
    if value == 0.0:
        return "0"
    return f"{round(value, place) + 0.0:.{max(place, 0)}f}"


def percent(probability: float) -> str:
    """Return a probability in per cent, which is never rounded to certainty."""
    if not 0.005 <= probability <= 0.995:
        return "< 1 %" if probability < 0.5 else "> 99 %"
    return f"{probability:.0%}".replace("%", " %")


def unit_html(unit: str) -> str:
    """Return a unit with raised exponents and lowered indices (HTML); nothing for a pure number."""
    if unit == "-":
        return ""
    raised = re.sub(r"\^(-?\([^)]*\)|-?\d+)", lambda found: f"<sup>{found[1].replace('-', '−')}</sup>", unit)
    return re.sub(r"m_(\w)", r"<i>m</i><sub>\1</sub>", raised)


def interval_with_unit(found: Mapping[Any, Any]) -> str:
    """Return `interval` of an entry that has a ``unit``, too, such as ``3.30 GPa (3.22 to 3.40)``."""
    number, _, span = interval_of(found).partition(" ")
    unit = "" if found["unit"] == "-" else f" {found['unit']}"
    return f"{number}{unit} {span}".strip()


def share_in_words(found: Mapping[str, Any]) -> str:
    """Return the size of a law's discrepancy with its interval, such as ``0.12 % of the depth (0.05 to 0.30)``."""
    estimate, lower, upper = (100.0 * found[key] for key in ("share", "lower", "upper"))
    return interval_with_unit({"estimate": estimate, "lower": lower, "upper": upper, "unit": "% of the depth"})
