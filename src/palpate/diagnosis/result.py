"""A diagnosis as `diagnosis.json` holds it, with the errors before and after on conditions that took no part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from palpate.calibration import Observation
from palpate.config import Condition, Study
from palpate.diagnosis.covariance import varying
from palpate.diagnosis.diagnose import Diagnosis
from palpate.diagnosis.fit import Fit
from palpate.diagnosis.locate import location
from palpate.diagnosis.next_test import discriminating_test
from palpate.diagnosis.refine import simulated_at
from palpate.diagnosis.similarity import similarity
from palpate.mechanisms import MECHANISMS

DRAWS = 2000
NORMAL_95 = 1.96


def mechanism_parameters(fit: Fit, rng: np.random.Generator) -> dict[str, dict[str, float]]:
    """Return estimate and 95 % interval of each parameter, as ``key.name``; of one that varies, of its mean."""
    problem = fit.problem
    draws = rng.multivariate_normal(fit.z, fit.posterior, size=DRAWS, method="svd").clip(0.0, 1.0)
    best = problem.amplitudes(fit.explanation, fit.z)
    drawn = [problem.amplitudes(fit.explanation, z) for z in draws]
    found = {}
    for key, values in best.items():
        for name, estimate in values.items():
            lower, upper = np.percentile([draw[key][name] for draw in drawn], [2.5, 97.5])
            found[f"{key}.{name}"] = {"estimate": estimate, "lower": float(lower), "upper": float(upper)}
    return found


def material_parameters(fit: Fit) -> dict[str, dict[str, float]]:
    """Return estimate and 95 % interval of every free material parameter."""
    space = fit.problem.space
    u = fit.z[: space.dimensions]
    half = NORMAL_95 * np.sqrt(np.diag(fit.posterior)[: space.dimensions])
    best, low, high = (space.named(np.clip(u + sign * half, 0.0, 1.0)) for sign in (0, -1, 1))
    free = [name for name, is_free in zip(best, space.free, strict=True) if is_free]
    return {name: {"estimate": best[name], "lower": low[name], "upper": high[name]} for name in free}


def curves(study: Study, observed: Mapping[str, Observation], before: Fit, after: Fit) -> pd.DataFrame:
    """Return the forward model's curves before and after beside the recorded means, for every condition.

    A mechanism that varies has a value of its own for each condition: the likeliest, given noise and scatter.
    """
    tables = []
    fitted = {"before_nm": before.problem.split(before.curve), "after_nm": after.problem.split(after.curve)}
    for condition in study.conditions:
        item = observed[condition.name]
        columns: dict[str, Any] = {"condition": condition.name, "role": item.role, "time_s": item.time}
        columns |= {"load_mN": condition.protocol.sample_load, "recorded_nm": item.mean}
        for name, fit in (("before_nm", before), ("after_nm", after)):
            known = fitted[name]
            curve = known[condition.name] if condition.name in known else simulated_at(study, condition, fit, fit.z)
            columns[name] = curve + own_values(fit, condition, item.mean - curve, len(item.depth))
        columns["noise_nm"] = np.sqrt(noise_variance(after, item))
        tables.append(pd.DataFrame(columns))
    return pd.concat(tables, ignore_index=True)


def own_values(fit: Fit, condition: Condition, residual: np.ndarray, count: int) -> np.ndarray:
    """Return what the varying mechanisms' departures from their mean value add under one condition (n_points,) [nm]."""
    total = np.zeros_like(residual)
    noise = fit.errors.noise
    for key in varying(fit.explanation):
        unit = {p.name: 1.0 for p in MECHANISMS[key].parameters}
        column = fit.problem.recorded_effect(key, condition, unit)
        weight = float(column @ column) / float(np.median(noise.sigma)) ** 2
        (plausible,) = MECHANISMS[key].plausible(fit.problem.scale).values()
        spread = noise.variances[key] / count if noise.replicated else (0.3 * plausible.upper) ** 2
        best = float(column @ residual) / float(column @ column)
        total += best * weight * spread / (1.0 + weight * spread) * column if spread > 0 else 0.0
    return total


def noise_variance(fit: Fit, item: Observation) -> np.ndarray:
    """Return the variance (n_points,) [nm^2] of a condition's mean curve."""
    noise = fit.errors.noise
    variance = float(np.median(noise.sigma)) ** 2 + noise.variances["site"] * item.mean**2
    variance = variance + noise.variances["wander"] * item.time + noise.variances["background"] * item.time**2
    return variance / len(item.depth)


def errors_before_after(table: pd.DataFrame) -> dict[str, Any]:
    """Return the root mean square misfits of calibrate and validate conditions, and the noise floor."""
    found: dict[str, Any] = {}
    for role in ("calibrate", "validate"):
        part = table[table["role"] == role]
        found[role] = {
            f"{when}_rmse_nm": _rms(part[f"{when}_nm"] - part["recorded_nm"]) if len(part) else None
            for when in ("before", "after")
        }
    judged = table[table["role"] == "validate"] if (table["role"] == "validate").any() else table
    return found | {"noise_nm": _rms(judged["noise_nm"])}


def _rms(values: pd.Series) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def limits(study: Study, observed: Mapping[str, Observation]) -> list[str]:
    """Say what cannot be known from these recordings."""
    taken = [observed[c.name] for c in study.conditions if c.role == "calibrate"]
    said = []
    if any(len(item.depth) < 2 for item in taken):
        said.append(
            "Some conditions have no replicates: scatter between sites and slow drift are assumed, not known, so no "
            "effect is named alone."
        )
    if len(taken) == 1:
        said.append("There is a single condition: effects of load, rate and time cannot be told apart by comparison.")
    if len({round(c.protocol.max_load, 9) for c in study.conditions if c.role == "calibrate"}) == 1:
        said.append(
            "All tests reach the same load: an effect with a length (rounding, film, size effect) or of the frame can "
            "hide in the material's parameters."
        )
    if not any(item.role == "validate" for item in observed.values()):
        said.append("No condition was held out: the gain cannot be shown on tests that took no part.")
    return said


def to_mapping(
    study: Study,
    observed: Mapping[str, Observation],
    diagnosis: Diagnosis,
    rng: np.random.Generator,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Return the content of `diagnosis.json` and the table of curves before and after."""
    base = diagnosis.base
    best = diagnosis.standing[0].fit if diagnosis.standing else base.fit
    table = curves(study, observed, base.fit, best)
    verdict = diagnosis.verdict
    candidates = [
        {
            "mechanisms": sorted(candidate.fit.explanation),
            "probability": probability,
            "log_evidence": candidate.fit.log_evidence,
            "parameters": mechanism_parameters(candidate.fit, rng),
            "p_value": candidate.examination.p_value,  # type: ignore[union-attr]
        }
        for candidate, probability in zip(diagnosis.standing, diagnosis.probabilities, strict=True)
    ]
    further = [candidate.fit for candidate in diagnosis.standing]
    content = {
        "verdict": verdict,
        "p_value": base.examination.p_value,  # type: ignore[union-attr]
        "location": location(base.fit),
        "similarity": similarity(base.fit),
        "mechanisms": sorted(best.explanation) if verdict == "identified" else [],
        "candidates": candidates,
        "discriminating_test": discriminating_test(study, further, rng) if verdict == "ambiguous" else None,
        "fit": errors_before_after(table),
        "parameters": {"before": material_parameters(base.fit), "after": material_parameters(best)},
        "tried": [
            {
                "mechanisms": sorted(candidate.fit.explanation),
                "log_evidence": candidate.fit.log_evidence,
                "p_value": candidate.examination.p_value if candidate.examination else None,
            }
            for candidate in diagnosis.tried
        ],
        "noise": {name: float(np.sqrt(v)) for name, v in base.fit.errors.noise.variances.items()}
        | {"sigma_nm": base.fit.errors.noise.sigma.tolist(), "memory": base.fit.errors.noise.memory.tolist()},
        "limits": limits(study, observed),
    }
    return content, table
