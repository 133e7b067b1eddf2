"""Confirmation by the forward model, and the correction of the surrogate that it allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from palpate.calibration.polish import WeightedFit

Confirm = Callable[[dict[str, float]], Mapping[str, np.ndarray]]


def correct(
    fit: WeightedFit, u: np.ndarray, confirm: Confirm, corrections: int
) -> tuple[WeightedFit, np.ndarray, Mapping[str, np.ndarray], list[dict[str, Any]]]:
    """Run the forward model at the estimate, shift the surrogate onto it, polish again; the best run counts.

    Returns
    -------
    fit, u, curves, confirmations
        The fit whose surrogate agrees with the forward model at u, u itself, the forward model's curves there,
        and one entry for each run.
    """
    best, confirmations = None, []
    for repeat in range(corrections + 1):
        values = fit.space.named(u)
        curves = confirm(values)
        raw = fit.with_offset({}).curves(u)
        fit = fit.with_offset({name: curves[name] - raw[name] for name in fit.measured})
        misfit = fit.chi_square(curves)
        worst = {name: float(np.abs(offset).max()) for name, offset in fit.offset.items()}
        confirmations.append({"parameters": values, "chi_square": misfit, "surrogate_error_nm": worst})
        if best is None or misfit < best[0]:
            best = (misfit, fit, u, curves)
        following = fit.solve([u])
        moved = fit.jacobian(u) @ (following - u)
        if moved @ moved < 0.01 * len(u) or repeat == corrections:
            break
        u = following
    assert best is not None
    return (*best[1:], confirmations)
