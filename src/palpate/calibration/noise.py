"""What is not the material in a recording: noise correlated in time, and scatter from site to site.

A recording r of a condition is modelled as  h_r(t) = (1 + d_r) h(t) + e_r(t),  with one depth factor d_r of standard
deviation `site` for each recording and noise e_r of standard deviation `sigma` and lag-one correlation `rho` (AR(1)).
The mean over n recordings then has the covariance  (sigma^2 rho^|i-j| + site^2 h_i h_j) / n.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import toeplitz
from scipy.signal import savgol_filter

ASSUMED_SITE_SCATTER = 0.01


@dataclass(frozen=True, eq=False)
class Observation:
    """All recordings of one condition at the sampling times of its protocol.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s]
    depths : ndarray, shape (replicates, n)
        [nm]
    sigma
        Standard deviation of the noise [nm].
    rho
        Correlation of the noise between neighbouring points.
    site
        Standard deviation of the depth factor; assumed where there are no replicates.
    """

    time: np.ndarray
    depths: np.ndarray
    sigma: float
    rho: float
    site: float

    @property
    def mean(self) -> np.ndarray:
        """Mean depth over the replicates [nm], shape (n,)."""
        return self.depths.mean(axis=0)

    def covariance(self, extra: np.ndarray | float = 0.0) -> np.ndarray:
        """Covariance (n, n) of the mean [nm^2], with a further independent variance `extra` at each point."""
        noise = self.sigma**2 * toeplitz(self.rho ** np.arange(len(self.time)))
        site = self.site**2 * np.outer(self.mean, self.mean)
        return (noise + site) / len(self.depths) + np.diag(np.broadcast_to(extra, len(self.time)) + 1e-6)


def observe(time: dict[str, np.ndarray], depths: dict[str, np.ndarray]) -> dict[str, Observation]:
    """Estimate noise and site scatter from all conditions together.

    Parameters
    ----------
    time : dict of ndarray, shape (n,)
        Sampling times of each condition [s].
    depths : dict of ndarray, shape (replicates, n)
        Depths of each condition [nm].
    """
    factors: list[float] = []
    freedom = 0
    noise = {}
    for name, curves in depths.items():
        mean = curves.mean(axis=0)
        if len(curves) > 1:
            slopes = curves @ mean / (mean @ mean)
            noise[name] = curves - slopes[:, None] * mean
            factors += list(slopes - slopes.mean())
            freedom += len(curves) - 1
        else:
            window = min(11, (len(mean) // 2) * 2 - 1)
            noise[name] = curves - savgol_filter(curves, window, 2, axis=1)
    site = float(np.sqrt(np.sum(np.square(factors)) / freedom)) if freedom else ASSUMED_SITE_SCATTER
    result = {}
    for name, curves in depths.items():
        sigma, rho = autoregression(noise[name], lost=1 if len(curves) > 1 else 0)
        result[name] = Observation(time[name], curves, sigma, rho, site)
    return result


def autoregression(residuals: Sequence[np.ndarray] | np.ndarray, lost: int) -> tuple[float, float]:
    """Return deviation and lag-one correlation of residual curves, `lost` of which were spent on their mean."""
    residuals = np.atleast_2d(residuals)
    variance = float(np.sum(residuals**2) / (residuals.shape[1] * max(len(residuals) - lost, 1)))
    lagged = float(np.sum(residuals[:, 1:] * residuals[:, :-1]))
    rho = lagged / max(float(np.sum(residuals[:, :-1] ** 2)), 1e-300)
    return float(np.sqrt(variance)), float(np.clip(rho, 0.0, 0.99))
