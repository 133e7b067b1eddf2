r"""How replicates differ, without a model: by a zero point, by a drift, by the site, and from test to test.

The difference of recording r from the mean h of its condition is taken as

    h_r - h = z_r + D_r t + s_r h + noise,

by least squares with correlated errors (`indentation_files.correlated_errors`). What the three coefficients scatter
beyond their own errors is the scatter of zero points, of drifts and of sites. What all recordings have in common does
not show here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import stdtrit

from indentation_files.correlated_errors import Series, shared_coefficient
from palpate.base import small_samples
from palpate.data.observation import Observation
from palpate.diagnosis.fact import Fact
from palpate.diagnosis.scaling_facts import Test, level
from palpate.mechanisms import MECHANISMS

SCATTER = {
    "zero points, constant in time": ("nm", ("zero_offset",), 0.0),
    "drifts, growing with time": (
        "nm/s",
        ("thermal_drift", "nonsteady_drift"),
        MECHANISMS["thermal_drift"].background,
    ),
    "sites, in proportion to the depth": ("-", (), 0.0),
}  # of replicates: unit, mechanisms, and what counts as background; a scatter of sites is none of the mechanisms


def differences(observed: Mapping[str, Observation]) -> list[Fact]:
    """Return the scatter between replicates that is constant, that grows with time, and in proportion to the depth."""
    groups: list[np.ndarray] = []
    errors: list[np.ndarray] = []
    for item in observed.values():
        count = len(item.response)
        if count > 1 and not item.own:
            found = [_coefficients(item.time, row - item.mean, item.mean) for row in item.response]
            values, deviations = np.array(found).transpose(1, 2, 0)
            groups.append(values)
            errors.append(np.mean(deviations**2, axis=1) * count / (count - 1.0))
    if not groups:
        return []
    return [
        Fact(f"scatter between replicates of {name}", *interval, unit, keys, 0.0, background)
        for k, (name, (unit, keys, background)) in enumerate(SCATTER.items())
        for interval in [small_samples.scatter([of[k] for of in groups], [of[k] for of in errors])]
    ]


def _coefficients(time: np.ndarray, difference: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return z, D and s (3,) of one recording's difference from the mean, and their standard deviations (3,)."""
    columns, found = np.column_stack([np.ones_like(time), time, depth]), []
    quantile = float(stdtrit(len(time) - 3, 0.975))
    for k in range(3):
        one = shared_coefficient([Series(difference, columns[:, k], np.delete(columns, k, axis=1))])
        found.append((one.value, one.half / quantile))
    values, deviations = np.array(found).T
    return values, deviations


def trend(tests: Sequence[Test]) -> list[Fact]:
    """Return by what share of the depth replicates change from one test to the next.

    Their order is that of ``# test_number: N``, where all have one, else that of the recordings of each condition.
    """
    numbers, levels, places = [], [], []
    for place, (condition, recordings) in enumerate(tests):
        values = np.array([level(condition.protocol, recording) for recording in recordings])
        told = [each.test_number for each in recordings if each.test_number is not None]
        order = np.array(told if len(told) == len(recordings) else range(len(recordings)), dtype=float)
        kept = np.isfinite(values)
        if kept.sum() > 1:
            numbers.append(order[kept])
            levels.append(values[kept])
            places.append(np.full(kept.sum(), place))
    if not numbers:
        return []
    own = (np.concatenate(places)[:, None] == np.array([each[0] for each in places])).astype(float)
    found = small_samples.slope(np.concatenate(numbers), np.concatenate(levels), own)
    return [Fact("change of the depth from test to test", *found, "1/test", ("test_trend",))] if found else []
