"""Undetected effects beside an accepted explanation: amplitudes of effects on the recorded depth.

By generalised least squares together with the parameters of the explanation, to first order about the best point; where
an exact law gives the amplitude, it is included. Intervals allow for a noise that is estimated (`estimated_noise`).
`undetected_effects` adds each effect outside the explanation by itself. A wide interval means that these recordings
neither show the effect nor rule it out. `joint_intervals` lets all effects considered act at once, in the explanation
or not: an amplitude whose interval is then wide is not determined by these recordings, however narrow its interval
under one explanation, and the parameter with which it correlates shows why. Two amplitudes with the same effect, as the
compliance of the frame and of the mount, are listed once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import t as student

from palpate.base.rounding import interval_of
from palpate.diagnosis.estimated_noise import adjusted
from palpate.diagnosis.screen import Screen
from palpate.inference.amplitude import Amplitude
from palpate.inference.explanation import PRIOR_VARIANCE, Fit
from palpate.mechanisms import MECHANISMS

UNIFORM = 1.0 / 3.0  # mean square of values distributed evenly from 0, or from -1, to 1
SHOWN_PRIOR_VARIANCE = 4.0 / 3.0  # of uniform values, in units of three quarters of a range
COARSE = 0.01  # of the largest depth, above which what an amplitude leaves uncertain is reported


@dataclass(frozen=True, eq=False)
class Extra:
    """An effect that joins an explanation in proportion to a coefficient of a prior `variance`.

    It is that of a mechanism, `key`, by its amplitude `name` (``key.name``; the key again where it is no amplitude).
    One unit adds a `column` (n_all,) to the depth [nm].
    """

    key: str
    name: str
    column: np.ndarray
    variance: float


@dataclass(frozen=True, eq=False)
class Joined:
    """All coordinates when effects join: those of the explanation, then the coefficients of the effects.

    One unit of each adds a column of the `design` (n_all, k) to the depth [nm]. From the best point they `change` (k,),
    with a `covariance` (k, k), were the noise known.
    """

    design: np.ndarray
    change: np.ndarray
    covariance: np.ndarray


def undetected_effects(fit: Fit, keys: Iterable[str]) -> dict[str, dict[str, float]]:
    """Return, as ``key.name``, estimate and 95 % interval of each mechanism in `keys` that only adds to the depth."""
    return {extra.name: _interval(fit, joined, place) for extra, joined, place in _each_beside(fit, keys)}


def _each_beside(fit: Fit, keys: Iterable[str]) -> Iterator[tuple[Extra, Joined, int]]:
    """Yield each amplitude of the mechanisms in `keys` that only add, how all changes with it, and its place there."""
    for key in [key for key in keys if key not in fit.explanation and _only_adds(key)]:
        extras = _amplitudes(fit, [key], prior_variance=np.inf)
        joined = _joined(fit, extras)
        for place, extra in enumerate(extras, len(fit.z)):
            yield extra, joined, place


@dataclass(frozen=True, eq=False)
class UndetectedEffect:
    """An effect as large as the recordings allow beside an explanation.

    Parameters
    ----------
    amplitude, value
        Its amplitude, and the end of the 95 % interval that is further from zero.
    change : ndarray, shape (k,)
        By how much the coordinates of the explanation change with it.
    adds
        What it adds to the depth at most [nm].
    """

    amplitude: Amplitude
    value: float
    change: np.ndarray
    adds: float


def largest_undetected(fit: Fit, keys: Iterable[str]) -> UndetectedEffect | None:
    """Return the effect that could add most to the depth; None where none could add 1 % of the largest depth.

    It is one of the mechanisms in `keys` that only add to the depth, as in `undetected_effects`.
    """
    found, own = [], len(fit.z)
    for extra, joined, place in _each_beside(fit, keys):
        interval = _interval(fit, joined, place)
        value = max(interval["lower"], interval["upper"], key=abs)
        along = joined.covariance[:own, place] / joined.covariance[place, place]
        change = joined.change[:own] + along * (value - joined.change[place])
        adds = abs(value) * float(np.abs(extra.column).max())
        (amplitude,) = (each for each in fit.problem.typical(extra.key) if str(each) == extra.name)
        found.append(UndetectedEffect(amplitude, value, change, adds))
    largest = max(found, key=lambda effect: effect.adds, default=None)
    return largest if largest and largest.adds > COARSE * float(np.abs(fit.problem.mean).max()) else None


def joint_intervals(fit: Fit, screen: Screen) -> dict[str, dict[str, Any]]:
    """Return, as ``key.name``, each amplitude that only adds to the depth if all screened mechanisms may act.

    The prior variance of each is that of a uniform distribution over its range. A mechanism that acts on the body joins
    with its effect at three quarters of its range: in the middle of the range, the angle of a tip or the modulus of a
    substrate may equal that of the base model. ``correlated_with`` is the coordinate with the largest posterior
    ``correlation``.
    """
    others = [key for key in screen.keys if key not in fit.explanation]
    extras = _amplitudes(fit, filter(_only_adds, others))
    extras += [Extra(key, key, screen.shown(key), SHOWN_PRIOR_VARIANCE) for key in others if not _only_adds(key)]
    joined = _joined(fit, extras)
    names = [*fit.coordinates.names, *(extra.name for extra in extras)]
    deviation = np.sqrt(np.diag(joined.covariance))
    found: dict[str, dict[str, Any]] = {}
    every = [f"{key}.{name}" for key in filter(_only_adds, screen.keys) for name in MECHANISMS[key].amplitudes]
    for name in [name for name in every if name in names]:
        place, acts = names.index(name), name in fit.coordinates.names
        value, slope = fit.problem.quantity(fit.explanation, fit.z, name) if acts else (0.0, 1.0)
        correlation = joined.covariance[place] / (deviation * deviation[place])
        correlation[place] = 0.0
        other = int(np.argmax(np.abs(correlation)))
        found[name] = {
            **_interval(fit, joined, place, value, slope),
            "correlated_with": names[other].split(".")[0],
            "correlation": float(np.sign(slope) * correlation[other]),
        }
    return found


def wide_intervals(fit: Fit, amplitudes: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Name the `amplitudes` from `joint_intervals` with wide intervals that another test could measure, and that test.

    An interval is wide when the depth that it leaves uncertain is more than 1 % of the largest depth. No test is named
    where an exact law gives the amplitude already.
    """
    messages, least = [], COARSE * float(np.abs(fit.problem.mean).max())
    for name, entry in amplitudes.items():
        key, own = name.split(".")
        (amplitude,) = (each for each in fit.problem.typical(key) if each.name == own)
        mechanism, half = MECHANISMS[key], 0.5 * (entry["upper"] - entry["lower"])
        if mechanism.remedy and half * float(np.abs(fit.problem.unit_effects(amplitude)).max()) > least:
            (unit,) = (p.unit for p in mechanism.parameters if p.name == own)
            done = any(law.quantity == name and np.isfinite(law.lower) for law in fit.constraints)
            remedy = "" if done else f" It would be narrowed by {mechanism.remedy}."
            of = "" if len(mechanism.amplitudes) == 1 else f"the {own} of "
            messages.append(
                f"If all effects considered may act at once, {of}{mechanism.title} is {interval_of(entry)} {unit}; it "
                f"correlates most with {entry['correlated_with'].replace('_', ' ')} "
                f"(correlation {entry['correlation']:+.2f}).{remedy}"
            )
    return messages


def _joined(fit: Fit, extras: list[Extra]) -> Joined:
    """Return how all coordinates change from the best point when effects join."""
    own = len(fit.z)
    design = np.column_stack([fit.tangent, *(extra.column for extra in extras)])
    white = fit.whiten(design)
    prior = np.append(np.full(own, 1.0 / PRIOR_VARIANCE), [1.0 / extra.variance for extra in extras])
    precision, pull = white.T @ white + np.diag(prior), white.T @ fit.white
    every = (*fit.explanation, *(extra.key for extra in extras))
    fit = replace(fit, constraints=tuple(law for law in fit.constraints if law.holds_under(every)))
    precision[:own, :own] += fit.constraint_tangent.T @ fit.constraint_tangent
    pull[:own] -= fit.constraint_tangent.T @ fit.from_constraints(fit.z)
    for place, extra in enumerate(extras, own):
        for law in [law for law in fit.constraints if law.quantity == extra.name]:
            precision[place, place] += law.weight(0.0) ** 2
            pull[place] -= law.weight(0.0) * law.departure(0.0)
    covariance = np.linalg.inv(precision)
    return Joined(design, covariance @ pull, covariance)


def _amplitudes(fit: Fit, keys: Iterable[str], prior_variance: float | None = None) -> list[Extra]:
    """Return the amplitudes of mechanisms, simple ones first, without those whose effect is present already.

    Parameters
    ----------
    prior_variance
        Prior variance of each; by default that of a uniform distribution over its range.
    """
    problem, values = fit.problem, fit.model.amplitudes(fit.z) if fit.explanation else {}
    present = [amplitude for key in filter(_only_adds, fit.explanation) for amplitude in Amplitude.of(key, values[key])]
    there, found = [problem.unit_effects(amplitude) for amplitude in present], []
    for key in sorted(keys, key=lambda key: len(MECHANISMS[key].parameters)):
        for amplitude in problem.typical(key):
            column = problem.unit_effects(amplitude)
            if not any(np.allclose(column, other) for other in there):
                variance = UNIFORM * problem.largest(amplitude) ** 2 if prior_variance is None else prior_variance
                found.append(Extra(key, str(amplitude), column, variance))
                there.append(column)
    return found


def _only_adds(key: str) -> bool:
    return not MECHANISMS[key].acts_on_body


def _interval(fit: Fit, joined: Joined, place: int, value: float = 0.0, slope: float = 1.0) -> dict[str, float]:
    """Return estimate and 95 % interval of what is `value` at the best point, and has a `slope` by a coordinate."""
    variance, freedom = adjusted(fit, joined.design, joined.covariance, place)
    estimate = value + slope * float(joined.change[place])
    half = abs(slope) * float(student.isf(0.025, freedom) * np.sqrt(variance))
    return {"estimate": estimate, "lower": estimate - half, "upper": estimate + half}
