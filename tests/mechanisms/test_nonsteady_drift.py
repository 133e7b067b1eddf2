"""A drift that dies away: its rates, its limits, and what single recordings show of it."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, RECORD_ONLY, problem, recordings, search_of

from palpate.configuration.settings import CalibrationSettings
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.individual_amplitudes import recording_values
from palpate.mechanisms import MECHANISMS

KEY = "nonsteady_drift"
RATE, AMPLITUDE, TIME = 0.1, 20.0, 12.0
STUDY = SimpleNamespace(conditions=CONDITIONS, calibration=CalibrationSettings(solver_error=0.003))


def added(time, rate=RATE, amplitude=AMPLITUDE, constant=TIME):
    values = {"rate": rate, "amplitude": amplitude, "time": constant}
    return MECHANISMS[KEY].record(time, np.zeros_like(time), np.zeros_like(time), values)


def test_the_rate_falls_from_its_first_value_to_the_steady_one():
    for begin, expected in ((0.0, RATE + AMPLITUDE / TIME), (60.0 * TIME, RATE)):
        first, second = added(np.array([begin, begin + 1e-4]))
        assert (second - first) / 1e-4 == pytest.approx(expected, rel=1e-4)


def test_a_time_far_beyond_the_test_is_a_steady_drift_and_one_far_below_it_an_offset():
    time = np.linspace(1.0, 60.0, 30)
    assert added(time, constant=1e5, amplitude=1e5) == pytest.approx((RATE + 1.0) * time, rel=1e-3)
    assert added(time, constant=1e-2) == pytest.approx(RATE * time + AMPLITUDE)


@pytest.fixture(scope="module")
def found():
    """Return the truth of every recording and a fit; the time differs from recording to recording, too."""
    rng, truth = np.random.default_rng(1), {}

    def drifting(condition, replicate):
        rate, amplitude, constant = np.array([RATE, AMPLITUDE, TIME]) * (1.0 + 0.2 * rng.standard_normal(3))
        truth[condition.name, replicate + 1] = {"rate": rate, "amplitude": amplitude}
        return added(condition.protocol.sample_time, rate, amplitude, constant)

    search = search_of(problem(recordings(np.random.default_rng(51), drifting)), [KEY, "thermal_drift"])
    steady, candidate = (search.candidate(search.joined(search.base.fit, key)) for key in ("thermal_drift", KEY))
    return truth, steady, candidate


def test_a_steady_drift_does_not_pass_for_it(found):
    _, steady, candidate = found
    assert steady.p_value < 0.01 < candidate.p_value
    assert candidate.fit.log_evidence > steady.fit.log_evidence + 10.0


def test_a_weak_one_is_found_from_where_least_squares_put_its_amplitudes():
    """Beside ranges of 300 nm: 6 nm. The search begins near it and stays."""
    observed = recordings(np.random.default_rng(100), lambda c, r: added(c.protocol.sample_time, 0.03, 6.0))
    search = search_of(problem(observed), [KEY])
    fit = search.joined(search.base.fit, KEY)
    place = fit.problem.place(fit.explanation, f"{KEY}.amplitude")
    amplitude, slope = fit.problem.quantity(fit.explanation, fit.z, f"{KEY}.amplitude")
    begun = search.screen.starts(search.base.fit, KEY)[0][place]
    assert amplitude == pytest.approx(6.0, abs=2.5)
    assert abs(begun - fit.z[place]) * slope < 6.0
    assert search.candidate(fit).p_value > 0.01


@pytest.mark.parametrize(("seed", "compliance"), [(1, 2.0), (2, 4.0)])
def test_a_steady_drift_beside_a_compliant_frame_does_not_pass_for_it(seed, compliance):
    """Both pairs of effects have as many parameters; the steady drift alone leaves more than noise."""

    def effect(condition, replicate):
        return compliance * condition.protocol.sample_load + (0.1 + 0.01 * replicate) * condition.protocol.sample_time

    observed = recordings(np.random.default_rng(seed), effect)
    found = diagnose(search_of(problem(observed), [*RECORD_ONLY, KEY]), lambda said: None)
    assert [set(each.fit.explanation) for each in found.accepted] == [{"thermal_drift", "frame_compliance"}]


def test_its_time_is_told_within_its_interval(found):
    _, _, candidate = found
    fit = candidate.fit
    value, slope = fit.problem.quantity(fit.explanation, fit.z, f"{KEY}.time")
    place = fit.problem.place(fit.explanation, f"{KEY}.time")
    assert abs(value - TIME) < 3.0 * slope * np.sqrt(fit.posterior[place, place])


def test_every_recording_has_its_own_rate_and_amplitude(found):
    truth, _, candidate = found
    fit = candidate.fit
    rows = recording_values(STUDY, fit.problem.observed, fit)
    assert set(rows) == {f"{KEY}.rate", f"{KEY}.amplitude"}
    held = [
        row["lower"] < truth[row["condition"], row["number"]][name.split(".")[1]] < row["upper"]
        for name, own in rows.items()
        for row in own
    ]
    assert np.mean(held) > 0.85
