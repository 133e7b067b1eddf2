"""A swing whose phase is each recording's own: named by what distinguishes replicates, and not by a mean."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, RECORD_ONLY, problem, recordings, search_of

from palpate.configuration.settings import CalibrationSettings
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.individual_amplitudes import recording_values
from palpate.mechanisms import MECHANISMS, checked_mechanisms

KEY = "room_temperature"
SIZE, PERIOD = 8.0, 60.0
STUDY = SimpleNamespace(conditions=CONDITIONS, calibration=CalibrationSettings(solver_error=0.003))


def test_without_a_phase_it_begins_at_its_middle():
    (values,) = checked_mechanisms({KEY: {"amplitude": SIZE, "period": PERIOD}}).values()
    time = np.linspace(0.0, 100.0, 50)
    added = MECHANISMS[KEY].record(time, time, np.zeros_like(time), values)
    assert added == pytest.approx(SIZE * np.sin(2.0 * np.pi * time / PERIOD))


def test_a_period_far_beyond_the_test_is_a_steady_drift_and_an_offset():
    time = np.linspace(0.0, 10.0, 50)
    values = {"amplitude": 1e3, "cosine": 2.0, "period": 1e4}
    added = MECHANISMS[KEY].record(time, time, np.zeros_like(time), values)
    assert added == pytest.approx(2.0 + 1e3 * 2.0 * np.pi / 1e4 * time, abs=1e-4)


@pytest.fixture(scope="module")
def found():
    """Return the phase of every recording, and the diagnosis."""
    rng, phases = np.random.default_rng(3), {}

    def swung(condition, replicate):
        phase = phases[condition.name, replicate + 1] = rng.uniform(0.0, 2.0 * np.pi)
        return SIZE * np.sin(2.0 * np.pi * condition.protocol.sample_time / PERIOD + phase)

    search = search_of(problem(recordings(rng, swung)), [*RECORD_ONLY, KEY])
    return phases, diagnose(search, lambda said: None)


def test_it_is_named_though_its_mean_says_nothing(found):
    assert found[1].verdict == "identified"
    assert [each.fit.explanation for each in found[1].accepted] == [(KEY,)]


def test_its_period_and_the_swing_of_every_recording_are_told(found):
    phases, diagnosis = found
    fit = diagnosis.accepted[0].fit
    assert fit.model.amplitudes(fit.z)[KEY]["period"] == pytest.approx(PERIOD, rel=0.05)
    rows = recording_values(STUDY, fit.problem.observed, fit)
    told = [
        (row["lower"] - 1.0, turn(phases[row["condition"], row["number"]]), row["upper"] + 1.0)
        for name, turn in (("amplitude", np.cos), ("cosine", np.sin))
        for row in rows[f"{KEY}.{name}"]
    ]
    assert np.mean([lower < SIZE * share < upper for lower, share, upper in told]) > 0.8
