"""The content of `diagnosis.json`, with the errors before and after on held-out conditions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.measures import root_mean_square
from palpate.data.observation import Observation
from palpate.diagnosis.diagnose import DiagnosisOutcome
from palpate.diagnosis.individual_amplitudes import in_mean, recording_values
from palpate.diagnosis.law_class import discrepancy
from palpate.diagnosis.limits import limits
from palpate.diagnosis.locate import CERTAIN, Residuals, missing_physics
from palpate.diagnosis.next_test import Account, discriminating_test
from palpate.diagnosis.nothing_further import nothing_further
from palpate.diagnosis.over_sets import draws_over_sets
from palpate.diagnosis.screen import Screen
from palpate.diagnosis.search import Candidate
from palpate.diagnosis.summary_text import RISEN
from palpate.diagnosis.undetected import largest_undetected
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.covariance import components_under
from palpate.inference.estimates import determined, law_discrepancy
from palpate.inference.explanation import Fit
from palpate.inference.posterior import draws_to_first_order
from palpate.mechanisms import MECHANISMS


def mechanism_parameters(fit: Fit, draws: np.ndarray) -> dict[str, dict[str, float]]:
    """Return median and 95 % interval of each parameter, as ``key.name``; of one that varies, of its mean."""
    drawn, best = pd.DataFrame([flat_amplitudes(fit, z) for z in draws]), flat_amplitudes(fit, fit.z)
    return {name: summary(drawn[name].to_numpy(), value) for name, value in best.items()}


def material_parameters(fit: Fit, draws: np.ndarray, explained: bool) -> dict[str, dict[str, float | bool]]:
    """Return median and 95 % interval of every free material parameter, and whether the recordings determine it.

    They determine none in a fit that does not explain them.
    """
    free = fit.coordinates.free[: fit.problem.material]
    lower, upper = np.percentile(draws, [2.5, 97.5], axis=0)
    known = determined(fit.coordinates, np.minimum(lower, fit.z), np.maximum(upper, fit.z))
    return {
        each.name: summary(each.physical(column), float(each.physical(best))) | {"identified": bool(explained and yes)}
        for each, column, best, yes in zip(free, draws.T, fit.z, known, strict=False)
    }


def material_at(fit: Fit) -> dict[str, float]:
    """Return every material parameter at the best point."""
    return {name: value for name, value in fit.coordinates.named(fit.z).items() if "." not in name}


def flat_amplitudes(fit: Fit, z: np.ndarray) -> dict[str, float]:
    """Return the mechanisms' parameters at coordinates z (k,), as ``key.name``."""
    found = fit.problem.amplitudes(fit.explanation, z)
    return {f"{key}.{name}": value for key, values in found.items() for name, value in values.items()}


def summary(values: np.ndarray, *best: float) -> dict[str, float]:
    """Return the median of draws, and the interval that holds 95 % of them and the `best` value, if there is one.

    A value at a limit lies outside of the quantiles of draws within it.
    """
    lower, estimate, upper = np.percentile(values, [2.5, 50.0, 97.5]).tolist()
    return {"estimate": estimate, "lower": min([lower, *best]), "upper": max([upper, *best])}


def curves(
    study: Study, observed: Mapping[str, Observation], before: Fit, after: Fit
) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return curves before and after beside the recorded means, for every condition, and which are left out, and why.

    These are the forward model's curves in fits of the base model (`before`) and of the best explanation (`after`), and
    the recordings `observed` [nm] under the conditions of a `study`. A mechanism that varies between recordings has the
    most likely value for each condition, given noise and scatter, and so has the factor of its site, where no
    replicates give that scatter. Parts that are held out have those of the rest of their test. Held-out conditions
    under which the forward model fails are left out.
    """
    tables, failed, tests = [], {}, {condition.name: condition for condition in study.conditions}

    def with_own(fit: Fit, condition: Condition, curve: np.ndarray) -> np.ndarray:
        """Return the `curve` (n_points,) [nm] of a condition with what single recordings of its test add."""
        test = tests[condition.test]
        fitted = fit.everywhere[test.name]
        assert not isinstance(fitted, str)  # a test of which parts are held out takes part in the fit
        departures = in_mean(study, fit, test, fitted, observed[test.name], condition)
        of_sites = fit.problem.split(fit.of_sites).get(test.name, np.zeros_like(fitted))
        of_part = of_sites if test is condition else curve * (of_sites @ fitted) / (fitted @ fitted)
        return curve + (departures + of_part)

    for condition in study.conditions:
        found = [fit.everywhere[condition.name] for fit in (before, after)]
        simulated = [curve for curve in found if not isinstance(curve, str)]
        if reasons := [curve for curve in found if isinstance(curve, str)]:
            failed[condition.name] = reasons[0]
            continue
        item = observed[condition.name]
        columns: dict[str, Any] = {"condition": condition.name, "role": item.role, "time_s": item.time}
        protocol = condition.protocol
        columns |= {f"{protocol.control}_{protocol.unit}": protocol.sample_drive, "recorded_nm": item.mean}
        for name, fit, curve in zip(("before_nm", "after_nm"), (before, after), simulated, strict=True):
            columns[name] = with_own(fit, condition, curve)
        columns["noise_nm"] = np.sqrt(noise_variance(after, condition, item))
        tables.append(pd.DataFrame(columns))
    return pd.concat(tables, ignore_index=True), failed


def noise_variance(fit: Fit, condition: Condition, item: Observation) -> np.ndarray:
    """Return the variance (n_points,) [nm^2] of a condition's mean curve, without that of sites if it is assumed."""
    parts = components_under(fit.problem, (), condition, item.mean)
    if not fit.problem.replicated:
        parts["site"] = np.zeros_like(parts["site"])
    return np.diag(fit.errors.noise.under(fit.problem.names, condition.name, parts)) / len(item.response)


def errors_before_after(table: pd.DataFrame) -> dict[str, Any]:
    """Return the root mean square misfits of calibrate and validate conditions, and the noise floor.

    `risen_nm` holds the misfit after of each condition under which it has risen, to more than its noise.
    """

    def errors(part: pd.DataFrame) -> list[float]:
        return [root_mean_square((part[when] - part["recorded_nm"]).to_numpy()) for when in ("before_nm", "after_nm")]

    found: dict[str, Any] = {}
    for role in ("calibrate", "validate"):
        part = table[table["role"] == role]
        before, after = errors(part) if len(part) else (None, None)
        found[role] = {"before_rmse_nm": before, "after_rmse_nm": after, "risen_nm": {}}
        for name, of_it in part.groupby("condition", sort=False):
            before, after = errors(of_it)
            if after > max(RISEN * before, root_mean_square(of_it["noise_nm"].to_numpy())):
                found[role]["risen_nm"][name] = after
    judged = table[table["role"] == "validate"] if (table["role"] == "validate").any() else table
    return found | {"noise_nm": root_mean_square(judged["noise_nm"].to_numpy())}


def over_all_sets(diagnosis: DiagnosisOutcome, screen: Screen, rng: np.random.Generator) -> dict[str, dict[str, float]]:
    """Return median and 95 % interval of each free material parameter, whichever mechanisms act."""
    draws = draws_over_sets(diagnosis.sets, screen, rng)
    free = diagnosis.base.fit.coordinates.free
    return {each.name: summary(each.physical(column)) for each, column in zip(free, draws.T, strict=True)}


def _next_test(
    study: Study, diagnosis: DiagnosisOutcome, of_base: np.ndarray, keys: Iterable[str]
) -> dict[str, Any] | None:
    """Return the test that separates what is open between two accounts of the recordings.

    These are the two best explanations, a suspected one and the base model, or, where that is adequate, the base model
    without and with the largest effect among `keys` that could hide beside it. The draws `of_base` (m, k) are from the
    posterior of the base model.
    """
    if not all(condition.observable.is_depth for condition in study.conditions):
        return None
    base = Account.of(diagnosis.base.fit, of_base)
    if diagnosis.verdict in ("suspected", "ambiguous"):
        accepted = [Account.of(candidate.fit, candidate.draws) for candidate in diagnosis.accepted[:2]]
        return discriminating_test(study, *[*accepted, base][:2])
    hidden = largest_undetected(diagnosis.base.fit, keys) if diagnosis.verdict == "adequate" else None
    return None if hidden is None else discriminating_test(study, base, base.with_hidden(hidden))


def _row(candidate: Candidate, probability: float, **more: Any) -> dict[str, Any]:
    """Return the row of an explanation with `more` entries."""
    fit = candidate.fit
    return {"mechanisms": sorted(fit.explanation), "probability": probability, "log_evidence": fit.log_evidence, **more}


def to_mapping(
    study: Study,
    observed: Mapping[str, Observation],
    diagnosis: DiagnosisOutcome,
    rng: np.random.Generator,
    screen: Screen,
    own_laws: Mapping[str, Sequence[Sequence[AmplitudeConstraint]]] | None,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Return the content of `diagnosis.json` and the table of curves before and after.

    Parameters
    ----------
    study, observed
        See `curves`.
    diagnosis
        The verdict and its fits.
    rng
        Source of the draws from posteriors.
    screen
        Effects of the mechanisms that were considered.
    own_laws
        Amplitudes that exact laws give for each recording of each condition.
    """
    base = diagnosis.base
    best, accepted = diagnosis.best.fit, diagnosis.accepted
    residuals = Residuals.of(base.fit, study.diagnosis.tolerance)
    location, pattern = residuals.located(), None
    if base.p_value < study.diagnosis.significance and all(row["q_value"] >= CERTAIN for row in location):
        pattern, _ = residuals.pattern({MECHANISMS[key].title: screen.shown(key) for key in screen.keys})
    table, failed = curves(study, observed, base.fit, best)
    verdict, noise = diagnosis.verdict, base.fit.errors.noise
    of_base = draws_to_first_order(base.fit, rng) if accepted else base.draws
    before = material_parameters(base.fit, of_base, verdict == "adequate")
    after = material_parameters(best, diagnosis.best.draws, explained=True) if accepted else before
    content = {
        "verdict": verdict,
        "law_within_tolerance": diagnosis.law_within_tolerance,
        "p_value": base.p_value,
        "location": location,
        "pattern": pattern,
        "missing": missing_physics(diagnosis.tried[0].fit) if verdict == "unexplained" else None,
        "mechanisms": sorted(best.explanation) if verdict == "identified" else [],
        "inclusion": diagnosis.inclusion,
        "family_inclusion": diagnosis.family_inclusion,
        "nothing_further": nothing_further(diagnosis, screen),
        "discrepancy": discrepancy(best),
        "discrepancy_base": law_discrepancy(base.fit),
        "candidates": [
            _row(
                each,
                probability,
                parameters=mechanism_parameters(each.fit, each.draws),
                p_value=each.p_value,
                recordings=recording_values(study, observed, each.fit, own_laws),
            )
            for each, probability in zip(accepted, diagnosis.probabilities, strict=True)
        ],
        "discriminating_test": _next_test(study, diagnosis, of_base, screen.keys),
        "fit": errors_before_after(table),
        "parameters": {"before": before, "after": after, "over_all_sets": over_all_sets(diagnosis, screen, rng)},
        "tried": [
            _row(
                each,
                diagnosis.all_sets.get(frozenset(each.fit.explanation), 0.0),
                discrepancy=law_discrepancy(each.fit),
                rmse_nm=root_mean_square(each.fit.left),
                parameters=flat_amplitudes(each.fit, each.fit.z),
                material=material_at(each.fit),
            )
            for each in diagnosis.tried
        ],
        "noise": {name: float(np.sqrt(v)) for name, v in noise.variances.items()}
        | {"sigma_nm": noise.sigma.tolist(), "autocorrelation": noise.autocorrelation.tolist()},
        "limits": limits(study, diagnosis, failed, rng),
    }
    return content, table
