"""Saved results of a small study without a solver: for tests of what shows them."""

from dataclasses import replace

import numpy as np
import pandas as pd
from study_file import load

from indentation_files.recording import SYNTHETIC, Recording
from palpate.output.saved_set import SavedSet

NAMES = ("youngs_modulus", "steady_coefficient", "steady_exponent")


def entry(estimate, half, **more):
    found = {"estimate": estimate, "lower": estimate - half, "upper": estimate + half, "identified": True}
    return found | {"held": False, "at_bound": False, "outside": False} | more


def calibration(ratio=1.8, replicates=3):
    errors = {"rmse_nm": 4.2, "r2": 0.99, "mean_abs_error_nm": 3.0, "percent_error": 1.0}
    return {
        "parameters": {
            "steady_exponent": entry(0.2, 0.0, held=True, identified=False),
            "youngs_modulus": entry(3.978, 0.31, identified=False, outside=True),
        },
        "conditions": {"A": errors | {"role": "calibrate"}, "B": errors | {"role": "validate", "rmse_nm": 8.61}},
        "noise": {"A": {"replicates": replicates}},
        "misfit_ratio": ratio,
        "converged": True,
        "seed": 1,
        "settings": {"objective": "mean_square"},
        "history": [{"generation": k, "best_sum": best} for k, best in enumerate((9.0, 4.0, 5.0))],
        "recordings": "lab",
        "condition_set": "all",
    }


DRIFT = {"thermal_drift.rate": {"estimate": 0.113, "lower": 0.101, "upper": 0.125}}


def diagnosis(verdict="identified", candidates=None, **more):
    """Return the content of diagnosis.json with a drift, as the code of today writes it; `more` adds entries."""
    named = {"mechanisms": ["thermal_drift"], "probability": 1.0, "log_evidence": -32.0, "parameters": DRIFT}
    candidates = ([] if verdict in ("adequate", "unexplained") else [named]) if candidates is None else candidates
    part = {"condition": "A", "segment": "loading", "residual_nm": -5.0, "q_value": 0.001}
    after = {"estimate": 3.304, "lower": 3.22, "upper": 3.40, "identified": bool(candidates) or verdict == "adequate"}
    base = {
        "mechanisms": [],
        "probability": 0.0,
        "log_evidence": -194.2,
        "rmse_nm": 3.7,
        "parameters": {},
        "material": {},
    }
    with_drift = {"mechanisms": ["thermal_drift"], "probability": 1.0, "log_evidence": -32.0, "rmse_nm": 1.6}
    return {
        "verdict": verdict,
        "p_value": 0.001,
        "location": [part | {"part": "early"}, part | {"part": "late", "residual_nm": -2.0, "q_value": 0.5}],
        "missing": None,
        "model_free": [],
        "mechanisms": ["thermal_drift"] if verdict == "identified" else [],
        "candidates": candidates,
        "discriminating_test": None,
        "fit": {
            "calibrate": {"before_rmse_nm": 3.7, "after_rmse_nm": 1.6, "risen_nm": {}},
            "validate": {"before_rmse_nm": 8.61, "after_rmse_nm": 5.42, "risen_nm": {}},
            "noise_nm": 2.1,
        },
        "parameters": {
            "before": {"youngs_modulus": after},
            "after": {"youngs_modulus": after},
            "over_all_sets": {"youngs_modulus": {"estimate": 3.31, "lower": 3.15, "upper": 3.48}},
        },
        "tried": [with_drift | {"parameters": {"thermal_drift.rate": 0.113}, "material": {}}, base],
        "limits": ["One limit."],
        "undetected_effects": {},
        "joint_intervals": {
            "thermal_drift.rate": DRIFT["thermal_drift.rate"] | {"correlated_with": "friction", "correlation": -0.6}
        },
        "laws": [],
        "zero_points": [],
        "sentence": "The base model does not explain the recordings.",
        "recordings": "lab",
    } | more


def saved(tmp_path, found=None, synthetic=True, **more):
    """Return the results of a set `lab` of two conditions with two tests each; `found` is its diagnosis."""
    protocol = {"max_load": 1.0, "loading_time": 30, "unloading_time": 30}
    conditions = [{"name": "A", **protocol}, {"name": "B", **protocol, "max_load": 0.5, "role": "validate"}]
    study = load(tmp_path, conditions=conditions, recordings={"lab": str(tmp_path)})
    tests, tables = {}, []
    for condition in study.conditions:
        time, load_ = condition.protocol.sample_time, condition.protocol.sample_drive
        depth = 400.0 * np.sqrt(load_)
        notes = (f"{SYNTHETIC}: made",) if synthetic else ()
        tests[condition.name] = [Recording(time, load_, depth + k, f"{condition.name}_{k}", notes) for k in (1, 2)]
        of = {"condition": condition.name, "role": condition.role, "time_s": time, "load_mN": load_}
        tables.append(pd.DataFrame(of | {"recorded_nm": depth + 1.5, "spread_nm": 1.0, "surrogate_nm": depth}))
        tables[-1]["simulated_nm"] = depth + 0.1 * time
    fit = pd.concat(tables, ignore_index=True)
    explained = fit.drop(columns=["spread_nm", "surrogate_nm"]).rename(columns={"simulated_nm": "before_nm"})
    explained = explained.assign(after_nm=explained["recorded_nm"] - 0.5, noise_nm=1.0)
    whole = SavedSet(study, "lab", tests, {"all": calibration()}, {"all": fit}, found, explained if found else None)
    summary = {"unit": "nm", "loo_rmse_nm": 0.05, "loo_rms_nm": [0.1, 0.2], "spectrum": [0.9, 0.1], "missing": ""}
    return replace(whole, surrogates={"A": summary}, **more)
