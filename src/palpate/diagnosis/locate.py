"""Where simulation and recordings differ: the mean residual of each part of a test, with false-discovery control."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import cho_solve
from scipy.stats import false_discovery_control
from scipy.stats import t as student

from palpate.inference.estimated_noise import freedom
from palpate.inference.explanation import Fit
from palpate.inference.prescribed_segments import segments

CERTAIN = 0.05  # share of false discoveries below which a misfit of a part is reported


def location(fit: Fit) -> list[dict[str, Any]]:
    """Return the mean residual (recorded less simulated) of each part, the most certain first.

    Its variance is that of the residual after the fit, C - T (T' C^-1 T)^+ T', and Student's distribution allows for a
    noise that is estimated (`estimated_noise`); q-values after Benjamini & Hochberg, J. R. Stat. Soc. B 57 (1995)
    289-300.
    """
    white = fit.whiten(fit.tangent)
    absorbed = fit.tangent @ np.linalg.pinv(white.T @ white, rcond=1e-10) @ fit.tangent.T
    left = np.eye(len(absorbed)) - cho_solve((fit.factor, True), absorbed)
    covariance = fit.errors.covariance - absorbed
    rows, p_values = [], []
    first = 0
    for condition in fit.problem.conditions:
        for name, where in segments(condition.protocol).items():
            places = first + np.flatnonzero(where)
            half = (len(places) + 1) // 2
            for part, chosen in (("early", places[:half]), ("late", places[half:]), ("whole", places)):
                mean = float(fit.residual[chosen].mean())
                variance = max(covariance[np.ix_(chosen, chosen)].mean(), 1e-12)
                free = freedom(fit, left[:, chosen].mean(axis=1), variance)
                rows.append({"condition": condition.name, "segment": name, "part": part, "residual_nm": mean})
                p_values.append(2 * student.sf(abs(mean) / np.sqrt(variance), free))
        first += len(condition.protocol.sample_time)
    for row, q in zip(rows, false_discovery_control(p_values), strict=True):
        row["q_value"] = float(q)
    return sorted(rows, key=lambda row: (row["q_value"], -abs(row["residual_nm"])))
