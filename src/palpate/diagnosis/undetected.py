"""What may still hide behind an explanation that stands: amplitudes of effects on the recorded depth.

By generalised least squares together with the parameters of the explanation, to first order about the best point; where
an exact law speaks of the effect, with that law. Intervals allow for a noise that is estimated (`estimated_noise`).
`may_hide` lets each effect that is not named join alone. A wide interval says that these recordings neither show the
effect nor rule it out. `open_amplitudes` lets all effects of the list act at once, named or not: an amplitude that then
may be anything is not known from these recordings, however narrow its interval under one explanation, and what it
trades with says why.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import t as student

from palpate.diagnosis.estimated_noise import adjusted
from palpate.diagnosis.explanation import PRIOR_VARIANCE, Fit
from palpate.diagnosis.screen import Screen
from palpate.mechanisms import MECHANISMS

EVEN = 1.0 / 3.0
SHOWN_BEFOREHAND = 4.0 / 3.0  # variance of even values in units of three quarters of a range, from the middle
COARSE = 0.01


@dataclass(frozen=True, eq=False)
class Extra:
    """An effect that joins an explanation in proportion to a coefficient.

    Parameters
    ----------
    key
        Its mechanism.
    column : ndarray, shape (n_all,)
        What one unit adds to the depth [nm].
    variance
        Of the coefficient beforehand.
    """

    key: str
    column: np.ndarray
    variance: float


@dataclass(frozen=True, eq=False)
class Joined:
    """All coordinates when effects join: those of the explanation, then the coefficients of the effects.

    Parameters
    ----------
    design : ndarray, shape (n_all, k)
        What one unit of each adds to the depth [nm].
    change : ndarray, shape (k,)
        From the best point.
    covariance : ndarray, shape (k, k)
        Were the noise known.
    """

    design: np.ndarray
    change: np.ndarray
    covariance: np.ndarray


def may_hide(fit: Fit, keys: Iterable[str]) -> dict[str, dict[str, float]]:
    """Return, as ``key.name``, estimate and 95 % interval of each mechanism in `keys` that only adds to the depth."""
    found = {}
    for key in [key for key in keys if key not in fit.explanation and _only_adds(key)]:
        joined = _joined(fit, [Extra(key, _unit_column(fit, key), np.inf)])
        found[_named(key)] = _interval(fit, joined, len(fit.z))
    return found


def open_amplitudes(fit: Fit, screen: Screen) -> dict[str, dict[str, Any]]:
    """Return, as ``key.name``, the amplitude of each mechanism that only adds to the depth if all screened may act.

    Each has beforehand the variance of an even distribution over its range. ``trades_with`` is the coordinate with the
    largest posterior ``correlation``.
    """
    extras = [_extra(fit, screen, key) for key in screen.keys if key not in fit.explanation]
    joined = _joined(fit, extras)
    names = _coordinates(fit) + [extra.key for extra in extras]
    deviation = np.sqrt(np.diag(joined.covariance))
    found: dict[str, dict[str, Any]] = {}
    for key in filter(_only_adds, screen.keys):
        place = names.index(key)
        value, slope = fit.problem.amplitude(fit.explanation, fit.z, key) if key in fit.explanation else (0.0, 1.0)
        correlation = joined.covariance[place] / (deviation * deviation[place])
        correlation[place] = 0.0
        other = int(np.argmax(np.abs(correlation)))
        found[_named(key)] = {
            **_interval(fit, joined, place, value, slope),
            "trades_with": names[other],
            "correlation": float(np.sign(slope) * correlation[other]),
        }
    return found


def not_fixed(fit: Fit, amplitudes: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Say which of the `amplitudes` from `open_amplitudes` are open though a law may give them, and by which test.

    An amplitude is open when what its interval leaves uncertain is more than 1 % of the largest depth. No test is named
    where the law speaks already.
    """
    said, least = [], COARSE * float(np.abs(fit.problem.mean).max())
    for name, entry in amplitudes.items():
        key = name.split(".")[0]
        mechanism, half = MECHANISMS[key], 0.5 * (entry["upper"] - entry["lower"])
        if mechanism.remedy and half * float(np.abs(_unit_column(fit, key)).max()) > least:
            unit = mechanism.parameters[0].unit
            done = any(law.key == key and np.isfinite(law.lower) for law in fit.laws)
            remedy = "" if done else f" It would be narrowed by {mechanism.remedy}."
            said.append(
                f"If all effects considered may act at once, {mechanism.title} lies between "
                f"{entry['lower']:.2g} and {entry['upper']:.2g} {unit}; it trades with "
                f"{entry['trades_with'].replace('_', ' ')} (correlation {entry['correlation']:+.2f}).{remedy}"
            )
    return said


def _joined(fit: Fit, extras: list[Extra]) -> Joined:
    """Return how all coordinates change from the best point when effects join."""
    own = len(fit.z)
    design = np.column_stack([fit.tangent, *(extra.column for extra in extras)])
    white = fit.whiten(design)
    prior = np.append(np.full(own, 1.0 / PRIOR_VARIANCE), [1.0 / extra.variance for extra in extras])
    precision, pull = white.T @ white + np.diag(prior), white.T @ fit.white
    every = (*fit.explanation, *(extra.key for extra in extras))
    fit = replace(fit, laws=tuple(law for law in fit.laws if law.holds_under(every)))
    precision[:own, :own] += fit.law_tangent.T @ fit.law_tangent
    pull[:own] -= fit.law_tangent.T @ fit.from_laws(fit.z)
    for place, extra in enumerate(extras, own):
        for law in [law for law in fit.laws if law.key == extra.key]:
            precision[place, place] += law.weight(0.0) ** 2
            pull[place] -= law.weight(0.0) * law.departure(0.0)
    covariance = np.linalg.inv(precision)
    return Joined(design, covariance @ pull, covariance)


def _extra(fit: Fit, screen: Screen, key: str) -> Extra:
    """Return a mechanism as an effect that joins; one that acts on the body is taken at three quarters of its range.

    In the middle a tip of another angle, or a substrate of another modulus, may be what the base model has.
    """
    if _only_adds(key):
        return Extra(key, _unit_column(fit, key), EVEN * fit.problem.largest(key) ** 2)
    return Extra(key, screen.shown(key), SHOWN_BEFOREHAND)


def _unit_column(fit: Fit, key: str) -> np.ndarray:
    return np.concatenate([fit.problem.unit_effect(key, condition) for condition in fit.problem.conditions])


def _coordinates(fit: Fit) -> list[str]:
    """Return the name of each coordinate: a material parameter, or a mechanism."""
    return [name.split(".")[0] for name in fit.coordinates.names]


def _only_adds(key: str) -> bool:
    return not MECHANISMS[key].acts_on_body


def _named(key: str) -> str:
    (parameter,) = MECHANISMS[key].parameters
    return f"{key}.{parameter.name}"


def _interval(fit: Fit, joined: Joined, place: int, value: float = 0.0, slope: float = 1.0) -> dict[str, float]:
    """Return estimate and 95 % interval of what is `value` at the best point, and has a `slope` by a coordinate."""
    variance, freedom = adjusted(fit, joined.design, joined.covariance, place)
    estimate = value + slope * float(joined.change[place])
    half = abs(slope) * float(student.isf(0.025, freedom) * np.sqrt(variance))
    return {"estimate": estimate, "lower": estimate - half, "upper": estimate + half}
