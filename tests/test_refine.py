"""The forward model's last word, with a closed form in its place."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_diagnosis import CONDITIONS, RECORD_ONLY, fitted, problem, recordings

from palpate.calibration import Observation
from palpate.calibration.space import Space
from palpate.config import load_study
from palpate.diagnosis import refine, sharpen
from palpate.diagnosis.correction import Correction
from palpate.diagnosis.design import scale_of
from palpate.diagnosis.detect import excess
from palpate.diagnosis.fit import Fit
from palpate.diagnosis.posterior import posterior_draws
from palpate.diagnosis.problem import Problem

STUDY = load_study(Path(__file__).parents[1] / "config" / "challenge.yaml")
DRIFT = ("thermal_drift",)


@pytest.fixture
def forward(monkeypatch):
    """Put the surrogates' curve, changed, in place of the forward model's; return where it was asked for."""
    asked = []

    def with_change(change):
        def simulated(study, conditions, fit, z):
            asked.extend((condition.name, z) for condition in conditions)
            curves = fit.problem.split(fit.problem.curves(fit.explanation, z[None])[0])
            return [curves[condition.name] + change(condition, z) for condition in conditions]

        def changes_from(study, fit, places):
            curves = np.array([np.concatenate(simulated(study, CONDITIONS, fit, z)) for z in places])
            return curves - curves[0]

        monkeypatch.setattr(refine, "simulated_at", simulated)
        monkeypatch.setattr(sharpen, "simulated_at", simulated)
        monkeypatch.setattr(sharpen, "changes_from", changes_from)
        return asked

    return with_change


def nothing(fit):
    return 0.0


def test_where_the_surrogates_are_wrong_the_fit_moves_to_what_the_forward_model_says(forward):
    forward(lambda condition, z: 20.0 * (z[0] - 0.3) * condition.protocol.sample_load / condition.protocol.max_load)
    task = problem(recordings(np.random.default_rng(1)))
    fit = fitted(task)
    found = refine.refine(STUDY, fit, nothing)
    simulated = np.concatenate(refine.simulated_at(STUDY, CONDITIONS, found, found.z))
    assert np.abs(found.curve - simulated).max() < 0.2
    assert found.misfit < len(task.mean) + 4 * np.sqrt(2 * len(task.mean))


def test_values_that_turn_out_to_differ_between_tests_stay_so(forward):
    rates = dict(zip("abcd", (0.5, -0.4, 0.3, -0.5), strict=True))
    forward(lambda condition, z: rates[condition.name] * condition.protocol.sample_time)
    found = refine.refine(STUDY, fitted(problem(recordings(np.random.default_rng(1))), DRIFT), nothing)
    assert np.sqrt(found.errors.between["thermal_drift"]) > 0.1


def test_a_fit_that_cannot_pass_is_simulated_once(forward):
    asked = forward(lambda condition, z: 10.0 * np.sin(condition.protocol.sample_time))
    fit = fitted(problem(recordings(np.random.default_rng(1))))
    found = refine.refine(STUDY, fit, lambda fit: 1e6)
    assert len(asked) == len(CONDITIONS)
    assert found.z == pytest.approx(fit.z, abs=refine.MARGIN)


def test_excess_is_what_chi_square_lacks():
    rng = np.random.default_rng(1)
    assert excess(fitted(problem(recordings(rng))), RECORD_ONLY, rng, 200, 0.01) == 0.0
    misfits, lacking = [], []
    for rate in (0.3, 0.5):
        drifting = recordings(np.random.default_rng(1), lambda c, r, rate=rate: rate * c.protocol.sample_time)
        fit = fitted(problem(drifting))
        misfits.append(fit.misfit)
        lacking.append(excess(fit, RECORD_ONLY, rng, 200, 0.01))
    assert 0.0 < lacking[0] < misfits[0]
    assert np.diff(lacking) == pytest.approx(np.diff(misfits), rel=0.1), "a filter sees all of a drift"


def test_a_promise_leaves_out_what_errors_of_surrogates_cost():
    fit = fitted(problem(recordings(np.random.default_rng(1))))
    assert fit.promise == pytest.approx(fit.log_evidence)
    error = 4.0 * np.eye(len(fit.residual))
    errors = replace(fit.errors, model=fit.errors.model + error, surrogate=error)
    unsure = replace(fit, errors=errors)
    assert unsure.log_evidence < fit.log_evidence - 100.0
    assert unsure.promise >= fit.log_evidence, "a wider covariance excuses misfit; it costs nothing here"


def test_what_a_fit_leaves_open_rests_on_the_forward_models_slopes(forward):
    """Where surrogates see twice the slope there is, and no step shows it, a fit knows the parameter twice as well."""
    task = problem(recordings(np.random.default_rng(1)))
    rough = fitted(task)
    slope = task.split(-0.5 * rough.tangent[:, 1])
    forward(lambda condition, z: (z[1] - rough.z[1]) * slope[condition.name])
    fit = refine.refine(STUDY, rough, nothing)
    sharpened = sharpen.sharpen(STUDY, fit)
    known, right = (np.sqrt(found.posterior[1, 1]) for found in (fit, sharpened))
    assert known == pytest.approx(np.sqrt(rough.posterior[1, 1]), rel=0.05)
    assert right == pytest.approx(2.0 * known, rel=0.1)


def test_a_bent_valley_is_followed_and_its_length_seen(forward):
    """Where the slope fades, by e over four standard deviations, the interval reaches further on that side."""
    task = problem(recordings(np.random.default_rng(2)))
    rough = fitted(task)
    slope = task.split(rough.tangent[:, 1])
    over = 4.0 * np.sqrt(rough.posterior[1, 1])

    def faded(condition, z):
        off = z[1] - rough.z[1]
        return (over * (1.0 - np.exp(-off / over)) - off) * slope[condition.name]

    forward(faded)
    found = sharpen.sharpen(STUDY, refine.refine(STUDY, rough, nothing))
    draws = posterior_draws(found, np.random.default_rng(2))[:, 1]
    low, middle, high = np.percentile(draws, [2.5, 50.0, 97.5])
    assert high - middle > 1.1 * (middle - low)
    assert middle - low < 0.5 * over


def bare(condition, factor):
    """Return a problem of one condition that knows of the mesh's error alone, and its material's space."""
    time = condition.protocol.sample_time
    space = Space({name: (min(levels), max(levels)) for name, levels in STUDY.levels.items()})
    observed, none = {condition.name: Observation(time, np.zeros((1, len(time))))}, {condition.name: {}}
    factors = {condition.name: np.full(len(time), factor)}
    return Problem((condition,), observed, space, {}, none, factors, scale_of(STUDY)), space


@pytest.mark.parametrize(("key", "own", "within"), [("second_voigt", 3, 0.01), ("plastic_yield", 2, 0.05)])
def test_changes_by_a_third_of_the_points_are_those_of_all(key, own, within):
    condition = STUDY.conditions[0]
    task, space = bare(condition, np.linspace(1.02, 1.01, len(condition.protocol.sample_time)))
    at = np.full(space.dimensions + own, 0.4)
    place = at + np.append([0.1, -0.1, 0.05, 0.1], np.full(own, 0.1))
    fit = Fit(task, (key,), at, None, Correction.none(1, len(at)))
    there, here = (np.concatenate(refine.simulated_at(STUDY, [condition], fit, z)) for z in (place, at))
    change = sharpen.changes_from(STUDY, fit, np.array([at, place]))[1]
    assert change == pytest.approx(there - here, abs=within * np.abs(there - here).max())


def test_an_optimum_beyond_a_grid_of_one_parameter_ends_the_search_at_its_edge(forward):
    forward(lambda condition, z: 0.0)
    task = problem(recordings(np.random.default_rng(11)))
    task = replace(task, space=Space({"modulus": (1.05, 1.4), "fluidity": (0.01, 0.01)}))
    assert refine.refine(STUDY, fitted(task), nothing).z == pytest.approx([0.0], abs=refine.MARGIN)


def test_the_mesh_errs_by_the_bodys_depth_not_by_what_the_instrument_adds():
    condition = STUDY.conditions[0]
    task, space = bare(condition, 1.02)
    z, key = np.append(np.full(space.dimensions, 0.4), 0.9), ("zero_offset",)
    offset = task.amplitudes(key, z)["zero_offset"]["offset"]
    fits = [Fit(task, found, at, None, Correction.none(1, len(at))) for found, at in (((), z[:-1]), (key, z))]
    body, recorded = (refine.simulated_at(STUDY, [condition], fit, fit.z)[0] for fit in fits)
    assert recorded - body == pytest.approx(np.full_like(body, offset))
    second = np.append(z[:-1], 0.4)
    changed = sharpen.changes_from(STUDY, fits[1], np.array([z, second]))[1]
    assert changed == pytest.approx(np.full_like(body, task.amplitudes(key, second)["zero_offset"]["offset"] - offset))
