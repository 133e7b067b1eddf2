r"""The correction of an amplitude's interval for a noise that is estimated, not known.

Generalised least squares gives an amplitude :math:`w^T r` of the residual r, with the variance V, as if the covariance
C(theta) of the curves were known. But the weights w depend on the estimate of theta, and so does V. To first order in
the errors of theta, with their covariance T, C_i = dC/dtheta_i and P = C^-1 projected off the fitted parameters,

    V_adjusted = V + 2 sum_ij T_ij w' C_i P C_j w
    freedom    = 2 V^2 / sum_ij T_ij (w' C_i w) (w' C_j w)

and the amplitude has Student's distribution (M.G. Kenward and J.H. Roger, Biometrics 53 (1997) 983-997; for a single
coefficient the freedom is Satterthwaite's). The errors of simulated curves count as known.

The mean residual of a part of a test has the same degrees of freedom. Its variance needs no correction: to the order
above, the variance that the fit absorbs is underestimated by as much as the errors of the weights add.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_solve

from palpate.data.noise import FURTHEST, NoiseModel
from palpate.inference.explanation import Fit


def adjusted(fit: Fit, design: np.ndarray, covariance: np.ndarray, place: int) -> tuple[float, float]:
    """Return the variance of a coefficient and its degrees of freedom.

    Parameters
    ----------
    fit
        An explanation at its best parameters.
    design : ndarray, shape (n_all, k)
        What one unit of each coefficient adds to the curves [nm].
    covariance : ndarray, shape (k, k)
        Of the coefficients, were the noise known.
    place
        Which coefficient.
    """
    variance, uncertain = float(covariance[place, place]), uncertainty(fit.errors.noise)
    weights = cho_solve((fit.factor, True), design @ covariance[:, place])
    slopes = fit.errors.slopes(weights)
    white = fit.whiten(slopes)
    absorbed = fit.whiten(design).T @ white
    left = white.T @ white - absorbed.T @ covariance @ absorbed
    grown = variance + 2.0 * max(float(np.sum(uncertain * left)), 0.0)
    return grown, _satterthwaite(variance, weights @ slopes, uncertain)


def freedom(fit: Fit, weights: np.ndarray, variance: float) -> float:
    """Return the degrees of freedom of the `variance` [nm^2] of ``weights @ curves``, with weights (n_all,)."""
    return _satterthwaite(variance, weights @ fit.errors.slopes(weights), uncertainty(fit.errors.noise))


def _satterthwaite(variance: float, by_estimates: np.ndarray, uncertain: np.ndarray) -> float:
    """Return the degrees of freedom of a variance, from its slopes (p,) by estimates with an `uncertain` (p, p)."""
    return 2.0 * variance**2 / float(by_estimates @ uncertain @ by_estimates)


def uncertainty(noise: NoiseModel) -> np.ndarray:
    """Return the covariance T of the estimates of the noise; log sigma and logit rho are known to within `FURTHEST`.

    Fisher's information determines neither near the largest autocorrelation, where the first order is of no use.
    """
    points = slice(0, 2 * len(noise.sigma))
    rows = noise.covariance[points]
    known = rows[:, points] + FURTHEST**2 * np.eye(len(rows))
    return noise.covariance - rows.T @ np.linalg.solve(known, rows)
