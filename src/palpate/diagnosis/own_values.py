"""The value of each single recording, for a mechanism that has one for each: the departure from the common curve."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.linalg import toeplitz

from palpate.calibration import Observation
from palpate.calibration.noise import model_covariance
from palpate.config import Study
from palpate.diagnosis.covariance import varying
from palpate.diagnosis.fit import Fit
from palpate.diagnosis.law import NORMAL_95
from palpate.diagnosis.refine import curve_under


def recording_values(study: Study, observed: Mapping[str, Observation], fit: Fit) -> dict[str, list[dict[str, Any]]]:
    """Return, as ``key.name``, one row a recording (condition, number, estimate, lower, upper), the held-out ones too.

    By generalised least squares of what a recording departs from the forward model's curve, given the common material
    and the common mean; its point noise, site scatter and the model's error are weighed, the uncertainty of the mean
    is added. Where several mechanisms vary they are found together.
    """
    keys = varying(fit.explanation)
    if not keys:
        return {}
    noise, best = fit.errors.noise, fit.problem.amplitudes(fit.explanation, fit.z)
    found: dict[str, list[dict[str, Any]]] = {}
    for condition in study.conditions:
        item = observed[condition.name]
        curve = curve_under(study, condition, fit)
        size = len(item.time)
        covariance = float(np.median(noise.sigma)) ** 2 * toeplitz(float(np.median(noise.memory)) ** np.arange(size))
        covariance += noise.variances["site"] * np.outer(curve, curve)
        covariance += model_covariance({condition.name: curve}, study.calibration["solver_error"])
        design = np.column_stack([fit.problem.unit_effect(key, condition) for key in keys])
        weighed = np.linalg.solve(covariance, design)
        spread = np.linalg.inv(design.T @ weighed)
        for number, depth in enumerate(item.depth, 1):
            departures = spread @ weighed.T @ (depth - curve)
            for key, departure, variance in zip(keys, departures, np.diag(spread), strict=True):
                ((name, mean),) = best[key].items()
                half = NORMAL_95 * float(np.sqrt(variance))
                value = float(mean + departure)
                row = {"condition": condition.name, "number": number, "estimate": value}
                found.setdefault(f"{key}.{name}", []).append(row | {"lower": value - half, "upper": value + half})
    return found
