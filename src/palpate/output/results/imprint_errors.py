"""What results show of imprints: errors of the residual profile, in tables and in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from palpate.base.rounding import rounded


def imprint_table(found: Mapping[str, Mapping[str, Any]]) -> pd.DataFrame:
    """Return one row an imprint of the entry ``imprint`` of ``calibration.json``, without the curves."""
    return pd.DataFrame(
        {"imprint": name} | {key: value for key, value in entry.items() if key != "curve"}
        for name, entry in found.items()
    )


def imprint_sentences(found: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Yield how far each profile lies from what the law predicts of it."""
    for name, entry in found.items():
        yield (
            f"Imprint {name} of {entry['of']}, predicted: root mean square error of the profile "
            f"{rounded(entry['rmse_nm'], 2)} nm, {rounded(entry['percent_error'], 2)} % of its depth; highest point "
            f"{rounded(entry['pile_up_nm'], 2)} nm recorded, {rounded(entry['predicted_pile_up_nm'], 2)} nm predicted."
        )


def imprint_facts(found: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the errors of all imprints in one line."""
    return "; ".join(
        f"{name}: {rounded(entry['rmse_nm'], 2)} nm, {rounded(entry['percent_error'], 2)} % of its depth"
        for name, entry in found.items()
    )


def imprint_metrics(found: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """Return the errors by plain keys, such as ``imprint.afm.rmse_nm``."""
    keys = ("rmse_nm", "percent_error")
    return {f"imprint.{name}.{key}": entry[key] for name, entry in found.items() for key in keys}
