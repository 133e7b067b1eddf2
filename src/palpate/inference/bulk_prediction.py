"""What a calibrated law predicts of uniaxial tests, and how far these lie from it, in their own units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palpate.data.bulk_tests import BulkTest
from palpate.models.bulk_model import BulkModel

DRAWS = 200  # of the posterior, whose quantiles are the band


def predicted(
    bulk: BulkModel, values: Mapping[str, float], draws: Sequence[Mapping[str, float]], confidence: float
) -> dict[str, dict[str, Any]]:
    """Return errors, and the predicted curve with its band, of each test by its name.

    The band is that of the law's parameters alone: it holds neither the noise of the test nor the law's discrepancy.

    Parameters
    ----------
    bulk
        The law and the tests.
    values
        Estimates of the law's parameters by name.
    draws
        Of their posterior; `DRAWS` of them are taken.
    confidence
        Of the band.
    """
    places = np.unique(np.linspace(0, len(draws) - 1, min(DRAWS, len(draws))).astype(int))
    chosen, ends = [draws[k] for k in places], [0.5 - confidence / 2, 0.5 + confidence / 2]
    found = {}
    for test in bulk.tests:
        curve = bulk.response(test, values)
        every = np.array([curve, *(bulk.response(test, each) for each in chosen)])
        reached = np.isfinite(every).sum(axis=0) > 0.5 * len(every)
        band = np.full((2, len(curve)), np.nan)
        band[:, reached] = np.nanquantile(every[:, reached], ends, axis=0)
        found[test.name] = _errors(test, curve, band) | {"curve": _curves(test, curve, band)}
    return found


def _errors(test: BulkTest, curve: np.ndarray, band: np.ndarray) -> dict[str, Any]:
    """Return role, control and errors of a predicted curve (n,) with its band (2, n), where the law bears the stress.

    ``percent_error`` is the root mean square error in per cent of the largest response, and ``within_band`` the share
    of the points that lie in the band, widened by two standard deviations of the noise.
    """
    borne = np.isfinite(curve) & np.isfinite(band).all(axis=0)
    measured, error = test.response[borne], curve[borne] - test.response[borne]
    about = {"role": test.role, "control": test.control, "points": len(curve)}
    if not borne.any():
        return about | {f"rmse_{test.unit}": None, "borne": 0.0}
    rmse, spread = float(np.sqrt(np.mean(error**2))), float(np.sum((measured - measured.mean()) ** 2))
    low, high = band[:, borne]
    wide = 2.0 * test.noise
    within = (measured > low - wide) & (measured < high + wide)
    return about | {
        f"rmse_{test.unit}": rmse,
        f"noise_{test.unit}": test.noise,
        "percent_error": 100.0 * rmse / float(np.abs(test.response).max()),
        "r2": 1.0 - float(np.sum(error**2)) / spread if spread else None,
        "within_band": float(np.mean(within)),
        "borne": float(np.mean(borne)),
    }


def _curves(test: BulkTest, curve: np.ndarray, band: np.ndarray) -> dict[str, list[float | None]]:
    """Return the recorded test, its predicted response (n,), a stress [GPa] or a strain, and the band (2, n)."""
    columns = {"time_s": test.test.time, "strain": test.test.strain, "stress_GPa": test.test.stress}
    columns |= {"predicted": curve, "lower": band[0], "upper": band[1]}
    return {name: [None if np.isnan(x) else float(f"{x:.7g}") for x in values] for name, values in columns.items()}
