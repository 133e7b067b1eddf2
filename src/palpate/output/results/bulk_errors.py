"""What results show of uniaxial tests of the bulk: errors in their own units, in tables and in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from palpate.base.rounding import percent, rounded

OBSERVED = {"strain": "stress", "stress": "strain"}  # what is compared, by what was prescribed
SHOWN_UNITS = {"strain": "GPa", "stress": "strain"}  # how names of errors end, likewise


def rmse_of(entry: Mapping[str, Any]) -> float | None:
    """Return the root mean square error of a test, of the stress [GPa] or the strain; None where it is not borne."""
    return entry[f"rmse_{SHOWN_UNITS[entry['control']]}"]


def bulk_table(found: Mapping[str, Mapping[str, Any]]) -> pd.DataFrame:
    """Return one row a test of the entry ``uniaxial`` of ``calibration.json``.

    Returns
    -------
    DataFrame
        test, role, prescribed, compared, rmse with its unit, percent_of_largest, noise likewise, and in_band, the share
        of points within the 95 % band of the law's parameters and the noise.
    """
    return pd.DataFrame(
        {
            "test": name,
            "role": entry["role"],
            "prescribed": entry["control"],
            "compared": OBSERVED[entry["control"]],
            "rmse": _with_unit(rmse_of(entry), entry),
            "percent_of_largest": entry.get("percent_error"),
            "noise": _with_unit(entry.get(f"noise_{SHOWN_UNITS[entry['control']]}"), entry),
            "in_band": percent(entry["within_band"]) if "within_band" in entry else None,
        }
        for name, entry in found.items()
    )


def _with_unit(value: float | None, entry: Mapping[str, Any]) -> str:
    """Return an error as text: of a stress in GPa, of a strain as a number."""
    return "-" if value is None else rounded(value, 2) + (" GPa" if entry["control"] == "strain" else "")


def bulk_sentences(found: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Yield how far each test lies from what the law predicts of it, or was fitted to."""
    for name, entry in found.items():
        what = "fitted" if entry["role"] == "calibrate" else "predicted"
        if rmse_of(entry) is None:
            yield f"Uniaxial test {name}: with these parameters the law bears none of its stress."
            continue
        part = "" if entry["borne"] == 1.0 else f" over the {percent(entry['borne'])} whose stress the law bears"
        yield (
            f"Uniaxial test {name}, {what}: root mean square error of the {OBSERVED[entry['control']]} "
            f"{_with_unit(rmse_of(entry), entry)}, {rounded(entry['percent_error'], 2)} % of its largest{part}; "
            f"{percent(entry['within_band'])} of its points within the 95 % band."
        )


def bulk_facts(found: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the errors of all tests in one line."""
    return "; ".join(
        f"{name}: the law bears none of its stress"
        if rmse_of(entry) is None
        else f"{name}: {_with_unit(rmse_of(entry), entry)}, {rounded(entry['percent_error'], 2)} % of the largest "
        f"{OBSERVED[entry['control']]}" + (" (fitted)" if entry["role"] == "calibrate" else "")
        for name, entry in found.items()
    )


def without_curves(found: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return the entries without their curves."""
    return {name: {key: value for key, value in entry.items() if key != "curve"} for name, entry in found.items()}


def bulk_metrics(found: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """Return the errors by plain keys, such as ``uniaxial.tension.rmse_GPa``."""
    keys = ("rmse_GPa", "rmse_strain", "percent_error", "within_band")
    return {
        f"uniaxial.{name}.{key}": entry[key]
        for name, entry in found.items()
        for key in keys
        if entry.get(key) is not None
    }
