"""Values of single recordings, on closed forms: each recording's own zero is found, its neighbours' are not."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from closed_forms import MATERIAL, TRUTH, ClosedForms, cone
from diagnosis_problem import CONDITIONS, fitted, recordings
from diagnosis_problem import problem as task

from palpate.configuration.condition import Condition
from palpate.configuration.settings import CalibrationSettings, DiagnosisSettings
from palpate.data.noise import NoiseModel
from palpate.data.observation import Observation
from palpate.diagnosis.diagnosis_result import curves, summary
from palpate.diagnosis.individual_amplitudes import in_mean, recording_values
from palpate.diagnosis.search import Search
from palpate.inference.amplitude import Amplitude
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.problem import Problem
from palpate.mechanisms import Scale
from palpate.models.coordinates import Coordinates
from palpate.solver.study_scale import longest_rise
from palpate.study.protocol import Protocol, trapezoid

CONDITION = Condition("a", "calibrate", trapezoid(4.0, 20.0, 10.0, 20.0, points=60))
SCALE = Scale(depth=1000, load=4.0, modulus=3.0, duration=50, loading_time=20, half_angle=70.3, pressure=0.2)
OFFSETS = np.array([48.0, 52.0, 55.0, 161.0])
ELASTIC = Coordinates(MATERIAL.free[:1], {"fluidity": 0.0})
DRIFT, ZERO = Amplitude("thermal_drift", "rate"), Amplitude("zero_offset", "offset")
STUDY = SimpleNamespace(
    conditions=(CONDITION,),
    calibration=CalibrationSettings(solver_error=0.001, site_scatter=0.01, law_error=0.0),
    diagnosis=DiagnosisSettings(bootstrap=400),
)


def solved(explanation, forward=ClosedForms):
    rng = np.random.default_rng(7)
    noise = rng.standard_normal((len(OFFSETS), 60))
    depth = cone(CONDITION.protocol, 1.0, 0.0) + OFFSETS[:, None] + noise
    observed = {"a": Observation(CONDITION.protocol.sample_time, depth)}
    problem = Problem((CONDITION,), observed, forward((CONDITION,), ELASTIC), SCALE)
    search = Search(STUDY, problem, [], rng, TRUTH)
    start = np.full(len(problem.coordinates(explanation).free), 0.5)
    return observed, search.fitted(explanation, [start], problem.mean)


def varied(**variances):
    """Return a fit to which the noise's variances are known, those of drift, zero and site, and its curve."""
    _, fit = solved(("thermal_drift", "zero_offset"))
    none = dict.fromkeys(fit.errors.noise.variances, 0.0)
    names = {"drift": str(DRIFT), "zero": str(ZERO), "site": "site"}
    noise = replace(fit.errors.noise, variances=none | {names[name]: v for name, v in variances.items()})
    return replace(fit, errors=replace(fit.errors, noise=noise)), fit.problem.split(fit.curve)["a"]


def recorded(mean):
    return Observation(CONDITION.protocol.sample_time, np.tile(mean, (4, 1)))


def test_every_recording_has_its_own_zero():
    observed, fit = solved(("zero_offset",))
    rows = recording_values(STUDY, observed, fit)["zero_offset.offset"]
    assert [row["number"] for row in rows] == [1, 2, 3, 4]
    assert [row["estimate"] for row in rows] == pytest.approx(OFFSETS, abs=1.5)
    assert all(row["lower"] < offset < row["upper"] for row, offset in zip(rows, OFFSETS, strict=True))


def test_two_effects_that_vary_share_what_they_both_could_explain():
    """A departure of the zero point alone is not counted again as a drift."""
    fit, curve = varied(drift=0.1, zero=100.0)
    departure = 5.0 * fit.problem.unit_effect(ZERO, CONDITION)
    assert in_mean(STUDY, fit, CONDITION, curve, recorded(curve + departure)) == pytest.approx(departure, rel=0.05)


def test_a_zero_far_from_all_others_is_believed():
    """The tip met dirt: 800 nm, where the other tests differ by 4."""
    fit, curve = varied(zero=16.0, site=1e-4)
    departure = 800.0 * fit.problem.unit_effect(ZERO, CONDITION)
    assert in_mean(STUDY, fit, CONDITION, curve, recorded(curve + departure)) == pytest.approx(departure, abs=1.0)


def test_the_depth_factor_of_a_site_is_not_taken_for_a_drift():
    """A drift of 0.3 nm/s would add 15 nm at the end, where a site that is softer by 1 % adds 3 to 10 nm."""
    fit, curve = varied(drift=0.1, site=1e-4)
    assert np.abs(in_mean(STUDY, fit, CONDITION, curve, recorded(1.01 * curve))).max() < 0.05 * 0.01 * curve.max()


def test_the_rates_of_single_recordings_lie_within_their_intervals():
    """Whatever the fit leaves open of the material: 95 % are expected, 60 % did where the material counted as known."""
    held = []
    for seed in range(10):
        rng, rates = np.random.default_rng(700 + seed), {}

        def drifting(condition, _, rng=rng, rates=rates):
            rates[condition.name] = 0.2 * (1.0 + 0.2 * rng.standard_normal())
            return rates[condition.name] * condition.protocol.sample_time

        observed = recordings(rng, drifting, replicates=1)
        problem, drift = task(observed), ("thermal_drift",)
        rough = fitted(problem, drift)
        fit = fitted(problem, drift, rough.z, rough.residual)
        study = SimpleNamespace(conditions=CONDITIONS, calibration=CalibrationSettings(solver_error=0.003))
        rows = recording_values(study, observed, fit)["thermal_drift.rate"]
        held += [row["lower"] < rates[row["condition"]] < row["upper"] for row in rows]
    assert np.mean(held) > 0.85


def test_what_belongs_to_the_instrument_has_no_value_of_a_recording():
    assert recording_values(STUDY, *solved(("frame_compliance",))) == {}


def test_loading_in_many_corners_lasts_as_long_as_loading_in_one():
    time = np.array([0.0, 10.0, 15.0, 18.0, 20.0, 30.0, 40.0, 44.0])
    load = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 4.0, 1.0, 2.0])
    assert longest_rise(Protocol(time, load, time[1:])) == 20.0
    assert longest_rise(CONDITION.protocol) == 20.0


def test_a_recordings_own_law_weighs_in():
    observed, fit = solved(("zero_offset",))
    sharp = [[AmplitudeConstraint("zero_offset", "offset", 60.0, 59.99, 60.01, "a test")], [], [], []]
    bound = [[], [], [], [AmplitudeConstraint("zero_offset", "offset", 150.0, -np.inf, 150.01, "a test")]]
    rows = recording_values(STUDY, observed, fit, {"a": sharp})["zero_offset.offset"]
    assert rows[0]["estimate"] == pytest.approx(60.0, abs=0.1)
    assert rows[1]["estimate"] == pytest.approx(52.0, abs=1.5)
    rows = recording_values(STUDY, observed, fit, {"a": bound})["zero_offset.offset"]
    assert rows[3]["estimate"] == pytest.approx(150.0, abs=0.1), "above the bound, where the curve alone says 161"
    assert rows[0]["estimate"] == pytest.approx(48.0, abs=1.5)


class Failing(ClosedForms):
    """Fails under a condition that took no part, where nothing is different but its name."""

    def under(self, names):
        if "b" in names:
            return SimpleNamespace(curves=lambda points: ["no equilibrium in 40 iterations"] * len(points))
        return replace(self, conditions=tuple(replace(CONDITION, name=name) for name in names))


def test_a_held_out_test_that_cannot_be_simulated_is_left_out():
    observed, fit = solved(("zero_offset",), Failing)
    conditions = (CONDITION, *(replace(CONDITION, name=name) for name in "bc"))
    study = SimpleNamespace(conditions=conditions, calibration=STUDY.calibration)
    for name in "bc":
        observed[name] = replace(observed["a"], role="validate")
    fit = replace(fit, problem=replace(fit.problem, recorded=observed))
    table, failed = curves(study, observed, fit, fit)
    assert set(table["condition"]) == {"a", "c"}
    assert failed == {"b": "no equilibrium in 40 iterations"}
    rows = recording_values(study, observed, fit)["zero_offset.offset"]
    assert {row["condition"] for row in rows} == {"a", "c"}


def test_values_that_differ_between_tests_count_in_the_means_where_replicates_agree():
    rates = dict(zip("abcd", (0.17, -0.1, -0.17, 0.1), strict=True))
    observed = recordings(np.random.default_rng(4), lambda c, r: (0.4 + rates[c.name]) * c.protocol.sample_time)
    fit = fitted(task(observed), ("thermal_drift",))
    assert fit.errors.between[str(DRIFT)] > 10.0 * fit.errors.noise.variances[str(DRIFT)]
    curves = fit.problem.split(fit.curve)
    mean = fit.problem.amplitudes(fit.explanation, fit.z)["thermal_drift"]["rate"]
    found, departed = [], []
    for condition in CONDITIONS:
        added = in_mean(STUDY, fit, condition, curves[condition.name], observed[condition.name])
        found.append(added[-1] / condition.protocol.sample_time[-1])
        departed.append(0.4 + rates[condition.name] - mean)
    assert np.dot(found, departed) > 0.4 * np.dot(departed, departed)


def test_an_interval_reaches_the_limit_at_which_the_best_value_lies():
    """Draws from half a normal distribution at its limit; the largest density is at zero."""
    draws = np.abs(np.random.default_rng(0).standard_normal(4000))
    found = summary(draws, 0.0)
    assert found["lower"] == 0.0
    assert found["upper"] == pytest.approx(2.24, abs=0.1)


def test_a_condition_has_its_own_noise_and_one_held_out_the_middle_one():
    noise = NoiseModel(np.array([0.2, 5.0, 0.3]), np.full(3, 0.5), {"site": 0.0}, 0.0, np.eye(7), True)
    parts = {"site": np.zeros((4, 4)), "unknown": np.eye(4)}
    found = [np.sqrt(noise.under(["a", "b", "c"], name, parts)[0, 0]) for name in "abcd"]
    assert found == pytest.approx([0.2, 5.0, 0.3, 0.3], rel=1e-5)
