"""The scoring rule, fixed before the trial: what counts as right, and the intervals that go with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

STRONG = 3.0
PLAIN = 1.5  # strength of the weaker of two effects from which both should be found
LONGEST = 60.0  # processor time of a diagnosis [s]
PROBABILITIES = [0.0, 0.5, 0.8, 0.95, 1.001]  # edges of the groups of answers
TARGETS = {
    "claims on null cases": ("at most", 0.01),
    "strong single effects covered": ("at least", 0.95),
    "wrong single name on strong single effects": ("at most", 0.01),
    "pairs exact or covered": ("at least", 0.80),
    "pairs whose weaker effect exceeds 1.5 times the limit covered": ("at least", 0.80),
    "unknown effects called unexplained": ("at least", 0.80),
    "intervals of amplitudes hold the truth": ("between", (0.90, 0.98)),
    "intervals of material parameters hold the truth": ("between", (0.90, 0.98)),
    "both intervals together hold the truth": ("between", (0.93, 0.97)),
    "held-out error within 1.2 of the noise after an identified effect": ("at least", 0.5),
    "diagnoses within 60 s of a core": ("at least", 0.98),
}


def row(case: Mapping[str, Any], diagnosis: Mapping[str, Any], strength: float) -> dict[str, Any]:
    """Return what one case contributes.

    Parameters
    ----------
    case
        Its truth.
    diagnosis
        Content of its `diagnosis.json`.
    strength
        Projected signature of its weakest library effect over the detection limit; NaN where there is none.
    """
    truth = sorted(case["mechanisms"])
    listed = [candidate["mechanisms"] for candidate in diagnosis["candidates"]]
    verdict = diagnosis["verdict"]
    fit = diagnosis["fit"]
    after, noise = fit["validate"]["after_rmse_nm"], fit["noise_nm"]
    return {
        "case": case["name"],
        "kind": case["kind"],
        "truth": "+".join(truth) or case["unknown"].get("key", ""),
        "verdict": verdict,
        "answer": " | ".join("+".join(names) for names in listed),
        "strength": strength,
        "claims": verdict in ("identified", "suspected", "ambiguous"),
        "exact": verdict == "identified" and diagnosis["mechanisms"] == truth,
        "covered": bool(truth) and any(names == truth for names in listed),
        "wrong_name": verdict == "identified" and diagnosis["mechanisms"] != truth,
        "foreign_name": verdict == "identified" and not set(diagnosis["mechanisms"]) <= set(truth),
        "top_probability": diagnosis["candidates"][0]["probability"] if listed else np.nan,
        "top_right": bool(listed) and listed[0] == truth,
        "over_noise": after / noise if after is not None else np.nan,
        "p_value": diagnosis["p_value"],
        "cpu_seconds": diagnosis.get("cpu_seconds"),
    } | intervals(case, diagnosis)


def intervals(case: Mapping[str, Any], diagnosis: Mapping[str, Any]) -> dict[str, int]:
    """Count the 95 % intervals that hold the truth, of named mechanisms and material, where the answer is right."""
    counts = {"amplitudes_held": 0, "amplitudes": 0, "material_held": 0, "material": 0}
    right = diagnosis["verdict"] == "adequate" and case["kind"] == "none"
    named = diagnosis["candidates"][0] if diagnosis["candidates"] else None
    if named and named["mechanisms"] == sorted(case["mechanisms"]):
        right = True
        for key, values in case["mechanisms"].items():
            for name, value in values.items():
                entry = named["parameters"][f"{key}.{name}"]
                counts["amplitudes"] += 1
                counts["amplitudes_held"] += entry["lower"] <= value <= entry["upper"]
    if right:
        for name, entry in diagnosis["parameters"]["after"].items():
            counts["material"] += 1
            counts["material_held"] += entry["lower"] <= case["parameters"][name] <= entry["upper"]
    return {key: int(value) for key, value in counts.items()}


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return each figure of merit with its Wilson interval and target."""
    null, one = table[table["kind"] == "none"], table[table["kind"] == "one"]
    two, unknown = table[table["kind"] == "two"], table[table["kind"] == "unknown"]
    strong, visible = one[one["strength"] >= STRONG], two[two["strength"] >= STRONG]
    plain, quick = two[two["strength"] > PLAIN], table["cpu_seconds"] <= LONGEST
    amplitudes, material = (table[[f"{kind}_held", kind]].sum() for kind in ("amplitudes", "material"))
    named = table[(table["verdict"] == "identified") & table["over_noise"].notna()]
    found = [
        ("claims on null cases", null["claims"].sum(), len(null)),
        ("strong single effects covered", strong["covered"].sum(), len(strong)),
        ("strong single effects named alone", strong["exact"].sum(), len(strong)),
        ("wrong single name on strong single effects", strong["wrong_name"].sum(), len(strong)),
        ("wrong single name on any single effect", one["wrong_name"].sum(), len(one)),
        ("pairs exact or covered", two["covered"].sum(), len(two)),
        ("pairs of two strong effects exact or covered", visible["covered"].sum(), len(visible)),
        ("pairs whose weaker effect exceeds 1.5 times the limit covered", plain["covered"].sum(), len(plain)),
        ("wrong single name on pairs", two["wrong_name"].sum(), len(two)),
        ("a name of what is not there on pairs", two["foreign_name"].sum(), len(two)),
        ("unknown effects called unexplained", (unknown["verdict"] == "unexplained").sum(), len(unknown)),
        ("intervals of amplitudes hold the truth", *amplitudes),
        ("intervals of material parameters hold the truth", *material),
        ("both intervals together hold the truth", *(amplitudes.to_numpy() + material.to_numpy())),
        (
            "held-out error within 1.2 of the noise after an identified effect",
            (named["over_noise"] <= 1.2).sum(),
            len(named),
        ),
        ("diagnoses within 60 s of a core", quick.sum(), len(table)),
    ]
    rows = [proportion(*entry) for entry in found]
    return pd.DataFrame([row | {"target": _target(str(row["figure"]))} for row in rows])


def brier(table: pd.DataFrame) -> float:
    """Return Brier's score of the probability of the first candidate being the truth."""
    answered = table[table["top_probability"].notna()]
    return float(np.mean((answered["top_probability"] - answered["top_right"]) ** 2)) if len(answered) else np.nan


def proportion(name: str, count: float, of: float) -> dict[str, Any]:
    """Return a figure with its count, of how many, and its share with Wilson's 95 % interval."""
    entry: dict[str, Any] = {"figure": name, "count": int(count), "of": int(of)}
    if of:
        interval = binomtest(int(count), int(of)).proportion_ci(method="wilson")
        entry |= {"share": count / of, "lower": interval.low, "upper": interval.high}
    return entry


def _target(name: str) -> str:
    words, bound = TARGETS.get(name, ("", ""))
    return f"{words} {bound}".strip()


def reliability(table: pd.DataFrame) -> pd.DataFrame:
    """Return how often the first candidate is right, by its stated probability."""
    answered = table[table["top_probability"].notna()]
    groups = pd.cut(answered["top_probability"], PROBABILITIES, right=False)
    return answered.groupby(groups, observed=False).agg(
        stated=("top_probability", "mean"), right=("top_right", "mean"), cases=("top_right", "size")
    )
