"""The prior of the coefficient of a screened effect, where an earlier study gives that of the mechanism's amplitudes.

A screened effect is taken in proportion to a coefficient c: the amplitudes lie so far on the way from where they have
no effect, u_0, to where the effect was simulated, u_1. With a joint normal prior of them and of the amplitudes that a
fit has already, the coefficient c = (u - u_0) (u_1 - u_0) / |u_1 - u_0|^2 and these are jointly normal, too.
"""

from __future__ import annotations

import numpy as np

from palpate.inference.explanation import Fit
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.instrument_prior import JointAmplitudes
from palpate.models.coordinates import Coordinate, Coordinates

NEUTRAL = 0.02  # of a range, within which an amplitude counts as none


def with_coefficient(fit: Fit, key: str, trials: np.ndarray) -> tuple[Coordinates, int] | None:
    """Return a fit's coordinates with the coefficient of a mechanism's effect behind them, and the number of the trial.

    None where no earlier study gives a prior of the amplitudes of the larger set.

    Parameters
    ----------
    fit
        An explanation that the mechanism joins.
    key
        The mechanism.
    trials : ndarray, shape (m, d)
        Coordinates of its amplitudes where the effect was simulated; the one nearest to what is expected is taken.
    """
    coordinates, k = fit.coordinates, len(fit.z)
    normal = coordinates.joined([MECHANISMS[key]], fit.problem.scale).normal
    own = normal.places >= k
    if not own.any():
        return None
    start = neutral_place(fit.problem, key)
    away = np.linalg.norm(trials - start, axis=1)
    number = int(np.argmin(np.where(away < NEUTRAL, np.inf, np.linalg.norm(trials - normal.mean[own], axis=1))))
    along = np.zeros(len(own))
    along[own] = (trials[number] - start) / away[number] ** 2
    shares, from_start = np.vstack([np.eye(len(own))[~own], along]), normal.mean.copy()
    from_start[own] -= start
    names = (*(coordinates.names[place] for place in normal.places[~own]), f"{key}.coefficient")
    known = JointAmplitudes(names, shares @ from_start, shares @ normal.covariance @ shares.T)
    coefficient = Coordinate(names[-1], 0.0, 1.0, -np.inf, np.inf)
    return Coordinates([*coordinates.free, coefficient], coordinates.held, known), number


def neutral_place(problem: Problem, key: str) -> np.ndarray:
    """Return the coordinates (d,) within their ranges at which a mechanism has the least effect."""
    added, neutral = problem.coordinates((key,)).free[problem.material :], MECHANISMS[key].neutral
    places = [float(each.scaled(neutral.get(each.name.split(".")[1], each.lower))) for each in added]
    return np.clip(places, 0.0, 1.0)
