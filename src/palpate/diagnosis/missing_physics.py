"""What physics that is in no library would have to change: where the closest explanation still differs, and how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palpate.configuration.condition import Condition
from palpate.diagnosis.locate import CERTAIN, Residuals
from palpate.inference.explanation import Fit
from palpate.solver.study_scale import longest_rise

CHANGES = {
    ("loading", True): "make the body softer {part}in loading",
    ("loading", False): "make the body stiffer {part}in loading",
    ("hold", True): "let it creep more {part}in the hold",
    ("hold", False): "let it creep less {part}in the hold",
    ("unloading", True): "let it recover less {part}in unloading",
    ("unloading", False): "let it recover more {part}in unloading",
}
APART = 1.5  # least ratio of loads, or of loading times, between tests that are compared


def missing_physics(fit: Fit) -> dict[str, Any]:
    """Return where a fit that is not accepted differs from the recordings.

    Returns
    -------
    content
        ``mechanisms`` of the fit; ``location``, as that of the base model; ``trends``, a row for the load and for the
        loading time where tests differ in it: `by`, `unit`, the values of the tests compared, `from` and `to`, their
        mean residuals there in parts of the largest depth, `residual_from` and `residual_to`, and `p_value` of their
        difference being noise.
    """
    residuals = Residuals.of(fit)
    return {"mechanisms": sorted(fit.explanation), "location": residuals.located(), "trends": _trends(residuals)}


def _trends(residuals: Residuals) -> list[dict[str, Any]]:
    fit, conditions = residuals.fit, residuals.fit.problem.conditions
    if not all(c.observable.is_depth for c in conditions):
        return []
    found = []
    loads, times = zip(*((c.protocol.largest_drive, longest_rise(c.protocol)) for c in conditions), strict=True)
    for by, unit, values in (("load", "mN", loads), ("loading time", "s", times)):
        low, high = min(values), max(values)
        if high < APART * low:
            continue
        first, last = (_weights(fit, conditions, np.isclose(values, end, rtol=0.05)) for end in (low, high))
        found.append(
            {"by": by, "unit": unit, "from": float(low), "to": float(high)}
            | {"residual_from": float(first @ fit.left), "residual_to": float(last @ fit.left)}
            | {"p_value": residuals.weighted(last - first)[1]}
        )
    return found


def _weights(fit: Fit, conditions: Sequence[Condition], which: np.ndarray) -> np.ndarray:
    """Return the weights (n_all,) that average a residual over some conditions, in parts of their largest depths."""
    parts = []
    for condition, chosen in zip(conditions, which, strict=True):
        depth = fit.problem.observed[condition.name].mean
        parts.append(np.full(len(depth), chosen / (len(depth) * depth.max() * which.sum())))
    return np.concatenate(parts)


def in_words(content: Mapping[str, Any]) -> str:
    """Return what the missing physics would have to change, most significant first; only significant parts count."""
    changes: dict[str, str] = {}
    for row in content["location"]:
        if row["q_value"] < CERTAIN and row["segment"] not in changes:
            part = "" if row["part"] == "whole" else f"{row['part']} "
            change = CHANGES[row["segment"], row["residual_nm"] > 0.0].format(part=part)
            changes[row["segment"]] = f"{change} of {row['condition']} ({row['residual_nm']:+.2g} nm)"
    if not changes:
        return ""
    text = f" What is missing would have to {_joined(list(changes.values()))}"
    for trend in content["trends"]:
        if trend["p_value"] < CERTAIN:
            ends = f"{trend['from']:.3g} to {trend['to']:.3g} {trend['unit']}"
            change = f"{trend['residual_from']:+.1%} to {trend['residual_to']:+.1%} of the depth"
            text += f"; from a {trend['by']} of {ends} the difference goes from {change}"
    return f"{text}."


def _joined(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
