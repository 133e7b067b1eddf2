"""Amplitudes that differ between recordings: the value of each single recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.inference.amplitude_constraint import NORMAL_95, AmplitudeConstraint
from palpate.inference.covariance import components_under, model_covariance, refinement_covariance
from palpate.inference.discrepancy import Discrepancy
from palpate.inference.explanation import Fit

ROUNDS = 20  # of the reweighting for Student's distribution, which converges by then


def recording_values(
    study: Study,
    observed: Mapping[str, Observation],
    fit: Fit,
    own_laws: Mapping[str, Sequence[Sequence[AmplitudeConstraint]]] | None = None,
) -> dict[str, list[dict[str, Any]]]:
    """Return, as ``key.name``, one row a recording (condition, number, estimate, lower, upper), the held-out ones too.

    By generalised least squares of a recording's departure from the forward model's curve, given the common material
    and the common mean, with the covariance of its point noise, site scatter, slow drift and the model's error. The
    intervals include the uncertainty of the material, except for held-out conditions, where the slopes are not known.
    Several mechanisms that vary are estimated together. A condition that takes no part, and in which one of them shows
    nothing, has no values, and neither have parts that are held out. What exact laws give for a single recording, such
    as the drift in its own hold, joins as data. Held-out conditions under which the forward model fails have no values.

    Parameters
    ----------
    study, observed
        The study, and the recordings of every condition in nm.
    fit
        An explanation in which amplitudes differ between recordings.
    own_laws
        Laws of each recording of each condition.
    """
    if not fit.own:
        return {}
    best, body = fit.problem.amplitudes(fit.explanation, fit.z), slice(fit.problem.material)
    names, means = [str(each) for each in fit.own], np.array([best[each.key][each.name] for each in fit.own])
    found: dict[str, list[dict[str, Any]]] = {}
    slopes, left_open = fit.problem.split(fit.tangent[:, body]), fit.posterior[body, body]
    for condition in study.conditions:
        item, curve = observed[condition.name], fit.everywhere[condition.name]
        if isinstance(curve, str) or condition.part_of:
            continue
        design = np.column_stack([fit.problem.unit_effect(amplitude, condition) for amplitude in fit.own])
        if not design.any(axis=0).all():
            continue
        weighed = np.linalg.solve(about(study, fit, condition, curve), design)
        for number, depth in enumerate(item.response, 1):
            own = own_laws[condition.name][number - 1] if own_laws and condition.name in own_laws else ()
            laws = [law for law in own if law.quantity in names and law.holds_under(fit.explanation)]
            placed = [(names.index(law.quantity), law) for law in laws]
            values, spread = _with_laws(design.T @ weighed, weighed.T @ (depth - curve), means, placed)
            if condition.name in slopes:
                moved = spread @ weighed.T @ slopes[condition.name]
                spread = spread + moved @ left_open @ moved.T
            halves = NORMAL_95 * np.sqrt(np.diag(spread))
            for name, value, half in zip(names, values.tolist(), halves.tolist(), strict=True):
                row = {"condition": condition.name, "number": number, "estimate": value}
                found.setdefault(name, []).append(row | {"lower": value - half, "upper": value + half})
    return found


def in_mean(
    study: Study, fit: Fit, condition: Condition, curve: np.ndarray, item: Observation, part: Condition | None = None
) -> np.ndarray:
    """Return the effect of departures from mean values on the mean of a condition's recordings (n_points,) [nm].

    The departures are jointly the most likely, given the variance of each, about a simulated `curve` (n_points,) [nm],
    see `about`, from the recordings of the condition in `item`. The variances rest on the number of replicates, so
    departures have Student's distribution with that many degrees of freedom: an outlier, as where a tip met dirt, is
    not pulled to the mean. The effect is that in a held-out `part` of the condition, if one is given.
    """
    noise, count, spreads = fit.errors.noise, len(item.response), {}
    for amplitude in fit.own:
        shown = noise.variances[str(amplitude)] / count + fit.errors.between.get(str(amplitude), 0.0)
        spread = shown if noise.replicated else (0.3 * fit.problem.largest(amplitude)) ** 2
        if spread > 0:
            spreads[amplitude] = spread
    shown_in = part or condition
    if not spreads:
        return np.zeros(len(shown_in.protocol.sample_time))
    design = np.column_stack([fit.problem.unit_effect(amplitude, condition) for amplitude in spreads])
    weighed = np.linalg.solve(about(study, fit, condition, curve, count), design)
    precision, pull, scales = design.T @ weighed, weighed.T @ (item.mean - curve), np.array(list(spreads.values()))
    freedom = sum(len(fit.problem.observed[each.name].response) - 1 for each in fit.problem.conditions)
    weights = np.ones(len(scales))  # of the prior, 1 in its middle
    for _ in range(ROUNDS if noise.replicated else 1):
        departures = np.linalg.solve(precision + np.diag(weights / scales), pull)
        weights = (freedom + 1.0) / (freedom + departures**2 / scales)
    effects = [fit.problem.unit_effect(amplitude, shown_in) for amplitude in spreads]
    return np.column_stack(effects) @ departures


def about(study: Study, fit: Fit, condition: Condition, curve: np.ndarray, count: int = 1) -> np.ndarray:
    """Return the covariance (n, n) [nm^2] of the mean of `count` recordings about a simulated `curve` (n,) [nm].

    The `study` states the error of the solver, and a `fit` has the noise of recordings under a `condition`.
    """
    noise = fit.errors.noise.under(
        fit.problem.names, condition.name, components_under(fit.problem, (), condition, curve)
    )
    refined = refinement_covariance([fit.problem.refinement(fit.model, condition)])
    common = model_covariance({condition.name: curve}, study.calibration.solver_error, fit.problem.shares)
    if law := fit.errors.law:
        alone = Discrepancy.of(
            [fit.problem.indentation(condition)], {condition.name: curve}, law.law_error, fit.problem.shares
        )
        common = common + alone.sized(law.size).covariance
    return noise / count + common + refined


def _with_laws(
    precision: np.ndarray, pull: np.ndarray, means: np.ndarray, laws: Sequence[tuple[int, AmplitudeConstraint]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the values (k,) about common means and their covariance, from a recording and its own laws, by place.

    A second pass weights a law by the side of its interval on which the first pass put the value.
    """
    departures = np.linalg.solve(precision, pull)
    for _ in range(2):
        weighed, pulled = precision.copy(), pull.copy()
        for place, law in laws:
            weight = law.weight(float(means[place] + departures[place])) ** 2
            weighed[place, place] += weight
            pulled[place] += weight * (law.estimate - means[place])
        departures = np.linalg.solve(weighed, pulled)
    return means + departures, np.linalg.inv(weighed)
