"""The misfit of a calibration in words, from the content of ``calibration.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from palpate.base.rounding import rounded, share_in_words


def progress(content: Mapping[str, Any]) -> str:
    """Return misfit, departure of the law, and whether the search has converged, in a few words."""
    errors = [entry["rmse_nm"] for entry in content["conditions"].values()]
    law = content.get("discrepancy")
    departure = f", a departure of the law by {share_in_words(law)}" if law else ""
    return f"misfit {span(errors)} nm{departure}{'' if content['converged'] else '; the search has not converged'}"


def span(errors: Sequence[float]) -> str:
    """Return the smallest and the largest error as text."""
    return f"{rounded(min(errors))} to {rounded(max(errors))}" if len(errors) > 1 else rounded(errors[0])
