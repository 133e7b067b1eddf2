"""The scoring rule, fixed before: names, intervals, and how often stated probabilities come true, by body."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from palpate.mechanisms import MECHANISMS
from studies.blind_trial.cases import Case
from studies.blind_trial.score import proportion
from studies.blind_trial.score import row as of_trial

LAWS = {"second_voigt", "plastic_yield", "friction"}  # they may stand in for a law that is not quite right
KNOWN = (0.0002, 0.00056)  # root mean square of what the two codes differ by within a test, as a share of the depth


def row(case: Case, diagnosis: dict[str, Any]) -> dict[str, Any]:
    """Return what one set contributes."""
    truth, ranked = sorted(case.mechanisms), [each["mechanisms"] for each in diagnosis["candidates"]]
    named = set(diagnosis["mechanisms"]) - set(truth)
    families = {MECHANISMS[key].family for key in truth}
    inclusion, of_family = diagnosis["inclusion"], diagnosis["family_inclusion"]
    after = diagnosis["parameters"]["after"]
    right = diagnosis["verdict"] == "adequate" if not truth else truth in ranked[:1]
    held = [entry["lower"] <= case.parameters[name] <= entry["upper"] for name, entry in after.items()]
    law = diagnosis["discrepancy"] or {"lower": np.nan, "upper": np.nan}
    return of_trial(vars(case), diagnosis, np.nan) | {
        "body": case.unknown["key"],
        "truth": "+".join(truth),
        "law_within_tolerance": str(diagnosis["law_within_tolerance"]),
        "among_two": truth in ranked[:2] if truth else right,
        "wrong_name": bool(named - LAWS),
        "stands_in": bool(named & LAWS),
        "least_true_family": min((of_family.get(family, 0.0) for family in families), default=np.nan),
        "largest_false": max((p for key, p in inclusion.items() if key not in truth), default=0.0),
        "nothing_further": diagnosis["nothing_further"]["probability"],
        "every_material": sum(held) if right else 0,
        "of_material": len(held) if right else 0,
        "discrepancy_lower": law["lower"],
        "discrepancy_upper": law["upper"],
    }


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return each figure with its Wilson interval; those by body count a set once."""
    null, acting = table[table["truth"] == ""], table[table["truth"] != ""]
    amplitudes, material = (
        table[["amplitudes_held", "amplitudes"]].sum(),
        table[["every_material", "of_material"]].sum(),
    )
    covers = (table["discrepancy_lower"] <= KNOWN[1]) & (table["discrepancy_upper"] >= KNOWN[0])
    rows = [
        ("claims where nothing is concealed", null["claims"].sum(), len(null)),
        ("wrong names", table["wrong_name"].sum(), len(table)),
        ("a law's mechanism named in its place", table["stands_in"].sum(), len(table)),
        ("concealed set named alone", acting["exact"].sum(), len(acting)),
        ("concealed set named or among the first two", acting["among_two"].sum(), len(acting)),
        ("intervals of amplitudes hold the truth", *amplitudes),
        ("intervals of material parameters hold the truth", *material),
        ("the discrepancy's interval meets what is known", covers.sum(), len(table)),
        ("diagnoses within 60 s of a core", (table["cpu_seconds"] <= 60.0).sum(), len(table)),
    ]
    return pd.DataFrame([proportion(*each) for each in rows])


def by_body(table: pd.DataFrame) -> pd.DataFrame:
    """Return the same of each body, whose sets share one error of the other code."""
    columns = ["claims", "wrong_name", "exact", "among_two", "amplitudes_held", "amplitudes"]
    found = table.groupby(["body", "kind"])[[*columns, "every_material", "of_material"]].sum()
    return found.assign(sets=table.groupby(["body", "kind"]).size())
