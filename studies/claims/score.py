"""How often what was stated is true, with Wilson's intervals, and how well probabilities are calibrated.

A claim is an answer with a mechanism of an instrument or of a length; one with a mechanism that changes the law may
stand in for a law that is not right, and is counted by itself. An effect acts in a set if it changes the mean depth of
some part of a test by more than the smallest effect, see `palpate.diagnosis.effect_size`; one that was planted and is
smaller counts neither way. It is strong if a refit of the material leaves at least the smallest effect of it, and at
least as much as of what no library holds: neither the parameters nor a discrepancy of that size reproduce it. A wrong
name is a mechanism of an instrument or of a length that is named, was not planted, and is no special or general case
of one that was.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.special import expit, logit
from scipy.stats import t as student

from palpate.diagnosis.parts import mean_changes
from palpate.mechanisms import MECHANISMS
from studies.blind_trial.score import proportion
from studies.claims.body import KEYS, Amplitudes, recorded
from studies.claims.departures import DEPARTURES
from studies.claims.diagnoses import posed
from studies.claims.sets import Case, left_by_refit
from studies.coverage.creep import burgers
from studies.coverage.score import wilson

LAWS = {"second_voigt"}  # it may stand in for a law that is not quite right
BETWEEN = (0.05, 0.95)  # probabilities whose calibration is asked for
CLASSES = ("scaling", "length", "clock", "reversal", "none")
FLOOR = 1e-3  # least probability that a score counts


def row(case: Case, stated: Mapping[str, Any], smallest: float) -> dict[str, Any]:
    """Return what one set contributes."""
    sizes, strong = planted(case, smallest)
    acting = {key for key, size in sizes.items() if size > smallest}
    alike = {
        other
        for key in sizes
        for other, mechanism in MECHANISMS.items()
        if {key, *MECHANISMS[key].includes} & {other, *mechanism.includes}
    }
    named, candidates = set(stated["named"]), [set(each) for each in stated["candidates"]]
    held, held_over_all = (
        [
            low <= case.parameters[name] <= high
            for name, low, high in _intervals(stated[of])
            if case.kind == "none" or name == "youngs_modulus"  # of another law only the elastic part is known
        ]
        for of in ("material", "over_all_sets")
    )
    amplitudes = [
        low <= case.mechanisms[key][name] <= high
        for full, low, high in _intervals(stated["amplitudes"])
        for key, name in [full.split(".")]
        if named == set(sizes) and key in sizes
    ]
    probabilities = stated["law"].get("class_probabilities") or {}
    return {
        "name": case.name,
        "kind": case.kind,
        "departure": case.departure,
        "misfit": case.misfit,
        "planted": len(sizes),
        "acting": "+".join(sorted(acting)),
        "strong": bool(strong) and all(strong.values()),
        "verdict": stated["verdict"],
        "answer": " | ".join("+".join(sorted(each)) for each in candidates),
        "claims": any(each - LAWS for each in candidates),
        "wrong_name": bool((named - LAWS) - alike),
        "stands_in": any((each & LAWS) - alike for each in candidates),
        "exact": named == acting and bool(acting),
        "among_two": bool(acting) and any(acting <= each | (alike & each) for each in candidates[:2]),
        "of_material": len(held),
        "held": sum(held),
        "held_over_all_sets": sum(held_over_all),
        "of_amplitudes": len(amplitudes),
        "amplitudes_held": sum(amplitudes),
        "discrepancy_holds": bool(
            stated["law"] and stated["law"]["lower"] <= max(case.misfit, 5e-4) and case.misfit <= stated["law"]["upper"]
        ),
        "class_score": float(np.log(max(probabilities.get(case.kind, 0.0), FLOOR))) if probabilities else np.nan,
        "nothing_further": stated["nothing_further"],
        "seconds": stated["seconds"],
    }


def inclusions(case: Case, stated: Mapping[str, Any], smallest: float) -> list[dict[str, Any]]:
    """Return the stated probability of each family, whether one of its mechanisms acts, and whether that is strong.

    Those that were planted and are too small are left out, and creep, which may stand in for a law that is not right.
    """
    (sizes, strong), found = planted(case, smallest), []
    for family in sorted({MECHANISMS[key].family for key in KEYS}):
        of = [size for key, size in sizes.items() if MECHANISMS[key].family == family]
        if (of and max(of) <= smallest) or (family == "creep" and case.kind == "scaling"):
            continue
        stated_as = stated["family_inclusion"].get(family, 0.0)
        clear = any(yes for key, yes in strong.items() if MECHANISMS[key].family == family)
        row = {"name": case.name, "kind": case.kind, "family": family, "stated": stated_as}
        found.append(row | {"acts": bool(of), "strong": clear})
    return found


def planted(case: Case, smallest: float) -> tuple[dict[str, float], dict[str, bool]]:
    """Return by how much each planted mechanism changes the mean depth of some part of a test [-], and if it is strong.

    Parameters
    ----------
    case
        The set.
    smallest
        Effect that counts as acting, as a share of the depth [-].
    """
    solid, sizes, strong = burgers(**case.parameters), dict[str, float](), dict[str, bool]()

    def depths(mechanisms: Amplitudes) -> np.ndarray:
        return np.concatenate([recorded(solid, each.protocol, mechanisms) for each in case.conditions])

    whole = depths(case.mechanisms)
    weights = np.array(list(mean_changes(posed(case), whole)))
    for key in case.mechanisms:
        change = whole - depths({other: values for other, values in case.mechanisms.items() if other != key})
        sizes[key] = float(np.abs(weights @ change).max())
        strong[key] = left_by_refit(case.conditions, case.parameters, change) >= max(smallest, case.misfit)
    return sizes, strong


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return each rate with its Wilson interval, over all sets and by what no library holds."""
    rows = []
    for kind, part in [("all", table), *table.groupby("kind")]:
        null, acting = part[part["planted"] == 0], part[part["acting"] != ""]
        strong = part[part["strong"]]
        rates = [
            ("claims where nothing is planted", null["claims"].sum(), len(null)),
            ("wrong names", part["wrong_name"].sum(), len(part)),
            ("a mechanism of the law stated in its place", part["stands_in"].sum(), len(part)),
            ("what acts named alone", acting["exact"].sum(), len(acting)),
            ("strong effects named alone", strong["exact"].sum(), len(strong)),
            ("strong effects named or among the first two", strong["among_two"].sum(), len(strong)),
            ("intervals of material parameters hold the truth", part["held"].sum(), part["of_material"].sum()),
            ("the same over all sets", part["held_over_all_sets"].sum(), part["of_material"].sum()),
            ("intervals of named amplitudes hold the truth", *part[["amplitudes_held", "of_amplitudes"]].sum()),
            ("the discrepancy's interval holds the misfit", part["discrepancy_holds"].sum(), len(part)),
        ]
        rows += [{"kind": kind, **proportion(*each)} for each in rates]
    return pd.DataFrame(rows)


def calibration(table: pd.DataFrame) -> dict[str, float]:
    """Return how stated probabilities of families compare with what is true.

    Returns
    -------
    dict
        `slope`, `lower`, `upper` of the logit of the truth over that stated, with its 95 % interval, of probabilities
        within `BETWEEN`, of which there are `count`; `log_score`, `brier_score` of all, and those of the base rate; and
        `strong`, the median of what was stated of families of which a strong effect acts.
    """
    stated, acts = table["stated"].to_numpy().clip(FLOOR, 1.0 - FLOOR), table["acts"].to_numpy(float)
    inner = (stated > BETWEEN[0]) & (stated < BETWEEN[1])
    x, y = logit(stated[inner]), acts[inner]

    def cost(b: np.ndarray) -> float:
        p = expit(b[0] + b[1] * x).clip(1e-12, 1.0 - 1e-12)
        return -float(np.sum(y * np.log(p) + (1.0 - y) * np.log1p(-p)))

    best = minimize(cost, np.array([0.0, 1.0])).x
    p = expit(best[0] + best[1] * x)
    design = np.column_stack([np.ones_like(x), x])
    deviation = float(np.sqrt(np.linalg.inv(design.T @ ((p * (1.0 - p))[:, None] * design))[1, 1]))
    reach, rate = float(student.isf(0.025, len(x) - 2)) * deviation, float(acts.mean())
    log_score = np.mean(np.log(np.where(acts > 0.5, stated, 1.0 - stated)))
    return {
        "count": len(x),
        "slope": float(best[1]),
        "lower": float(best[1] - reach),
        "upper": float(best[1] + reach),
        "log_score": float(log_score),
        "log_score_of_rate": float(rate * np.log(rate) + (1.0 - rate) * np.log1p(-rate)),
        "brier_score": float(np.mean((acts - stated) ** 2)),
        "brier_score_of_rate": rate * (1.0 - rate),
        "strong": float(table.loc[table["strong"], "stated"].median()),
    }


def reliability(
    table: pd.DataFrame, edges: Sequence[float] = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
) -> pd.DataFrame:
    """Return how often a family acts by the probability that was stated, with Wilson intervals."""
    rows = []
    for group, part in table.groupby(pd.cut(table["stated"], list(edges), include_lowest=True), observed=True):
        lower, upper = wilson(int(part["acts"].sum()), len(part))
        rows.append(
            {
                "stated": str(group),
                "mean": part["stated"].mean(),
                "acts": part["acts"].mean(),
                "lower": lower,
                "upper": upper,
                "count": len(part),
            }
        )
    return pd.DataFrame(rows)


def class_scores(table: pd.DataFrame) -> pd.DataFrame:
    """Return the mean log score of the class of what is left, by class, beside that of the base rate."""
    known = table[table["class_score"].notna()]
    shares = known["kind"].value_counts(normalize=True)
    return pd.DataFrame(
        {
            "log_score": known.groupby("kind")["class_score"].mean(),
            "log_score_of_rate": np.log(shares),
            "sets": known["kind"].value_counts(),
        }
    ).loc[[name for name in ("none", *DEPARTURES) if name in shares]]


def _intervals(stated: Mapping[str, Mapping[str, float]]) -> list[tuple[str, float, float]]:
    return [(name, each["lower"], each["upper"]) for name, each in stated.items()]
