"""How often intervals hold the truth, with Wilson's intervals, by class of set; the truth is opened here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import norm

from studies.coverage.creep import POISSON_RATIO
from studies.coverage.sets import RIGHT, Case
from studies.coverage.solid import RANGES

RESOLVED = 0.99  # of the compliance that acts within the shortest interval between samples, the least elastic part


def row(case: Case, fit: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is scored of a set.

    The modulus is compared with that of the elastic part, and with that of all that acts within the shortest interval
    between samples, which recordings cannot distinguish from it. Of the other parameters a wrong law has no true value.
    """
    right = case.family == RIGHT
    elastic = (1.0 - POISSON_RATIO**2) / case.truth.instantaneous
    shortest = min(float(np.diff(c.protocol.sample_time, prepend=0.0).min()) for c in case.conditions)
    at_resolution = (1.0 - POISSON_RATIO**2) / float(case.truth.at(np.array([shortest]))[0])
    found = {
        "name": case.name,
        "family": case.family,
        "law": "right" if right else "wrong",
        "replicated": "replicated" if case.replicates > 1 else "single",
        "tests": len(case.tests),
        "resolved": at_resolution > RESOLVED * elastic,
        "misfit": case.misfit,
        "law_error": fit["law_error"],
    }
    truths = {**case.parameters, "youngs_modulus": elastic} if right else {"youngs_modulus": elastic}
    for name in RANGES:
        lower, upper = fit[f"{name}.lower"], fit[f"{name}.upper"]
        found[f"{name}.identified"] = fit[f"{name}.identified"]
        found[f"{name}.width"] = float(np.log(upper / lower))
        if name in truths:
            found[f"{name}.holds"] = bool(lower <= truths[name] <= upper)
    lower, upper = fit["youngs_modulus.lower"], fit["youngs_modulus.upper"]
    found["reaches_resolution"] = bool(lower <= elastic and at_resolution <= upper)
    found["youngs_modulus.off"] = float(np.log(fit["youngs_modulus.estimate"] / elastic))
    if "law.share" in fit:
        found["law.share"] = fit["law.share"]
        found["law.holds"] = bool(fit["law.lower"] <= case.misfit <= fit["law.upper"])
    return found


def table(cases: Mapping[str, Case], fits: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the rows of all fits."""
    return pd.DataFrame([row(cases[fit["name"]], fit) for fit in fits])


def of_law_errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return, for the sets that were fitted with several `law_error`, what the modulus' intervals hold, and widths."""
    several = table[table.groupby("name")["law_error"].transform("size") > 1]
    columns = {"sets": ("name", "size"), "share": ("youngs_modulus.holds", "mean")}
    return several.groupby(["law", "law_error"]).agg(**columns, median_width=("youngs_modulus.width", "median"))


def wilson(held: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return Wilson's interval of a proportion (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209-212)."""
    z = float(norm.isf(0.5 - confidence / 2))
    middle, spread = held + z**2 / 2, z * np.sqrt(held * (count - held) / count + z**2 / 4)
    return float((middle - spread) / (count + z**2)), float((middle + spread) / (count + z**2))


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return shares of intervals that hold the truth, by class, with Wilson's intervals and median widths."""
    rows = []
    classes = {"all": table, **{f"{law} law": part for law, part in table.groupby("law")}}
    for (law, replicated), part in table.groupby(["law", "replicated"]):
        classes[f"{law} law, {replicated}"] = part
    for (law, tests), part in table.groupby(["law", "tests"]):
        classes[f"{law} law, tests: {tests}"] = part
    for name, part in table[table["law"] == "wrong"].groupby("resolved"):
        classes[f"wrong law, {'no creep' if name else 'creep'} within the first interval"] = part
    for label, part in classes.items():
        for quantity in (*RANGES, "law"):
            of = part[part[f"{quantity}.identified"]] if quantity in RANGES else part[part["law"] == "wrong"]
            held = of[f"{quantity}.holds"].dropna() if f"{quantity}.holds" in of else pd.Series(dtype=bool)
            if len(held):
                rows.append(_shares(label, quantity, held.astype(bool), of.get(f"{quantity}.width")))
    return pd.DataFrame(rows)


def _shares(label: str, quantity: str, held: pd.Series, width: pd.Series | None) -> dict[str, Any]:
    count, of = len(held), int(held.sum())
    lower, upper = wilson(of, count)
    found = {"class": label, "quantity": quantity, "intervals": count, "share": of / count}
    median = float(width.loc[held.index].median()) if width is not None else np.nan
    return found | {"lower": lower, "upper": upper, "median_width": median}
