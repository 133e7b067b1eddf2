"""Linear viscoelastic closed forms fitted to a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from palpate.classical import ting
from palpate.classical.viscoelastic_depth import MODELS, Compliance, depth_while_growing
from palpate.errors import InputError
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol

LIMITS = {  # GPa, 1/(GPa s), 1/GPa, s: far beyond those of any solid
    "youngs_modulus": (1e-3, 1e4),
    "steady_coefficient": (1e-9, 1e3),
    "transient_coefficient": (1e-6, 1e3),
    "retardation_time": (1e-3, 1e5),
}


@dataclass(frozen=True, eq=False)
class ViscoelasticFit:
    """Outcome of a fit.

    Attributes
    ----------
    values
        Parameters by name, those of the nonlinear Burgers law at zero exponents.
    depth : ndarray, shape (n,)
        Fitted depth at all sampling times [nm]; NaN in unloading when only loading was fitted.
    rmse_nm
        Root mean square misfit of the points that were fitted [nm].
    """

    values: Mapping[str, float]
    depth: np.ndarray
    rmse_nm: float


def fit_viscoelastic(
    model: str, indenter: Indenter, protocol: Protocol, depth: np.ndarray, poisson_ratio: float, *, unloading: bool
) -> ViscoelasticFit:
    """Fit one of `MODELS` to depths (n,) [nm] at the protocol's sampling times, from several starts.

    Parameters
    ----------
    model
        Name of one of `MODELS`.
    indenter, protocol
        Tip and load history of the test.
    depth : ndarray, shape (n,)
        Recorded depths [nm].
    poisson_ratio
        Of the half-space [-], constant in time.
    unloading
        Fit the whole curve by Ting's solution; otherwise loading and hold alone.

    Raises
    ------
    InputError
        On a model that is not known, or when a whole curve is to be fitted whose load rises again after it has fallen.
    """
    if model not in MODELS:
        raise InputError(f"model {model!r} is not known", remedy=f"use one of: {', '.join(MODELS)}", place="model")
    names = MODELS[model].names
    bounds = np.log([LIMITS[name.removesuffix("_2")] for name in names]).T
    growing = protocol.sample_time <= protocol.knot_time[np.flatnonzero(protocol.knot_load == protocol.max_load)[-1]]
    fitted = np.ones(len(depth), dtype=bool) if unloading else growing

    def curve(x: np.ndarray) -> np.ndarray:
        compliance = Compliance.of(dict(zip(names, np.exp(x), strict=True)), poisson_ratio)
        solve = ting.depth if unloading else depth_while_growing
        return solve(compliance, indenter, protocol)

    duration = float(protocol.sample_time[-1])
    elastic = depth_while_growing(Compliance(1.0, 0.0, ()), indenter, protocol)[growing][-1]
    ratio = depth[growing][-1] / elastic
    compliance = ratio**2 if indenter.shape == "cone" else ratio**1.5
    attempts = []
    for share in (0.05, 0.3):
        begin = {
            "youngs_modulus": 1.0 / compliance,
            "steady_coefficient": compliance / duration,
            "transient_coefficient": compliance,
            "retardation_time": share * duration,
            "retardation_time_2": 0.1 * share * duration,
        }
        start = np.log([begin.get(name, begin[name.removesuffix("_2")]) for name in names])
        start = np.clip(start, bounds[0] + 1e-6, bounds[1] - 1e-6)
        attempts.append(least_squares(lambda x: (curve(x) - depth)[fitted], start, bounds=bounds, max_nfev=200))
    best = min(attempts, key=lambda attempt: attempt.cost)
    return ViscoelasticFit(
        dict(zip(names, map(float, np.exp(best.x)), strict=True)),
        np.where(fitted, curve(best.x), np.nan),
        float(np.sqrt(2 * best.cost / fitted.sum())),
    )
