"""How far a simulated curve lies from a measured one."""

from __future__ import annotations

import numpy as np

from palpate.data.observation import Observation
from palpate.errors import InputError
from palpate.observables.depth import DEPTH
from palpate.observables.observable import Quantity


def root_mean_square(values: np.ndarray) -> float:
    """Return the root of the mean square of values (n,), in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))


def mean_square(measured: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """Objective of the thesis' chapter 5, mean((h_exp - h_sim)^2) over the points, the last axis [nm^2]."""
    return np.mean((simulated - measured) ** 2, axis=-1)


def relative(measured: np.ndarray, simulated: np.ndarray) -> np.ndarray:
    """Objective of the thesis' chapter 4, sqrt(mean(((h_sim - h_exp)/h_exp)^2)) over the last axis [-]."""
    return np.sqrt(np.mean(((simulated - measured) / measured) ** 2, axis=-1))


OBJECTIVES = {"mean_square": mean_square, "relative": relative}


def check_measurable(name: str, measured: np.ndarray, objective: str) -> None:
    """Raise `InputError` where the relative objective would divide by what is not positive."""
    if objective == "relative" and np.any(measured <= 0):
        raise InputError(
            f"the mean curve of {name} is not positive at point {int(np.argmin(measured)) + 1}, "
            "so that its relative error is undefined",
            remedy="use the objective mean_square",
            place="objective",
        )


def check_indents(name: str, item: Observation) -> None:
    """Raise `InputError` where the response is constant or nowhere positive: errors relative to it are undefined."""
    measured, response = item.mean, item.quantity
    if np.ptp(measured) == 0.0 or measured.max() <= 0.0:
        raise InputError(
            f"the mean {response.name} of {name} is {measured.min():g} to {measured.max():g} {response.unit}, which is "
            "no indentation",
            remedy=f"check the column {response.name}_{response.unit} of its recordings, and its sign",
            place=name,
        )


def error_measures(measured: np.ndarray, simulated: np.ndarray, quantity: Quantity = DEPTH) -> dict[str, float]:
    """Error table of the thesis' chapter 5 for one curve, which passes `check_indents`.

    Returns
    -------
    dict
        `rmse_nm`; `r2`, 1 - sum of squared errors / sum of squares about the mean; `mean_abs_error_nm`;
        `percent_error`, the mean of 100 |error| / value over points above 1 % of the largest value. In another unit
        than nm also `rmse_UNIT` and `mean_abs_error_UNIT`; the errors in nm are then the equivalent depths under the
        same load, see `palpate.observables.observable`.
    """
    error = simulated - measured
    deep = measured > 0.01 * measured.max()
    rms, mean = root_mean_square(error), float(np.mean(np.abs(error)))
    found = {
        "rmse_nm": quantity.nm * rms,
        "r2": float(1.0 - np.sum(error**2) / np.sum((measured - measured.mean()) ** 2)),
        "mean_abs_error_nm": quantity.nm * mean,
        "percent_error": float(100.0 * np.mean(np.abs(error[deep]) / measured[deep])),
    }
    own = {quantity.observable.column("rmse"): rms, quantity.observable.column("mean_abs_error"): mean}
    return found if quantity.unit == "nm" else found | own
