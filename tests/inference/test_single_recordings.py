"""Calibration on one recording of each condition, where noise cannot be distinguished from misfit."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from test_calibration import BOUNDS, FAMILIES, QUICK, TRUTH, T, calibrated

from palpate.data.observation import Observation

TRUE = np.array(list(TRUTH.values()))


def one_recording():
    """Return a curve of each condition that no parameters give: 12 nm too deep halfway."""
    off = 12.0 * np.sin(np.pi * T / T[-1])
    return {
        name: Observation(T, (family.predict(TRUE[None])[0] + off)[None], "calibrate")
        for name, family in FAMILIES.items()
    }


def calibrated_with(solver_error, seed=0):
    return calibrated(
        one_recording(), settings=QUICK.model_copy(update={"solver_error": solver_error, "law_error": 0.0}), seed=seed
    )


@pytest.mark.parametrize("solver_error", [0.0, 0.03])
def test_the_fit_is_that_of_least_squares_whatever_error_the_solver_may_have(solver_error):
    recorded = np.concatenate([item.mean for item in one_recording().values()])

    def residual(x):
        row = np.array([[*x, TRUTH["c"], TRUTH["d"]]])
        return np.concatenate([family.predict(row)[0] for family in FAMILIES.values()]) - recorded

    expected = least_squares(residual, TRUE[:2], x_scale=[b - a for a, b in list(BOUNDS.values())[:2]], xtol=1e-12).x
    for seed in range(2):
        found = calibrated_with(solver_error, seed).parameters
        assert [found[name].estimate for name in "ab"] == pytest.approx(expected, rel=2e-3)
