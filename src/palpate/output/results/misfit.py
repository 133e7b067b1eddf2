"""The misfit of a calibration in words, from the content of ``calibration.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from palpate.base.rounding import interval, rounded


def departure_in_words(content: Mapping[str, Any]) -> str:
    """Return the discrepancy of the law with its interval; empty where the law counts as exact."""
    found = content.get("discrepancy")
    if found is None:
        return ""
    share = {key: 100.0 * found[key] for key in ("lower", "upper")}
    return f"{interval(100.0 * found['share'], **share)} % of the depth"


def progress(content: Mapping[str, Any]) -> str:
    """Return misfit, departure of the law, and whether the search has converged, in a few words."""
    errors = [entry["rmse_nm"] for entry in content["conditions"].values()]
    departure = departure_in_words(content)
    departure = departure and f", a departure of the law by {departure}"
    return f"misfit {span(errors)} nm{departure}{'' if content['converged'] else '; the search has not converged'}"


def span(errors: Sequence[float]) -> str:
    """Return the smallest and the largest error as text."""
    return f"{rounded(min(errors))} to {rounded(max(errors))}" if len(errors) > 1 else rounded(errors[0])
