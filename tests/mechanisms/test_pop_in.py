"""Jumps at loads of their own: one sharp jump in a recording, their moments over recordings, and the diagnosis."""

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, problem, recordings, search_of

from palpate.diagnosis.diagnose import diagnose
from palpate.mechanisms import MECHANISMS, checked_mechanisms
from palpate.study.protocol import trapezoid

KEY = "pop_in"
JUMP, LOAD, SCATTER = 15.0, 0.3, 0.15


def test_a_recording_jumps_once_and_keeps_its_jump():
    (values,) = checked_mechanisms({KEY: {"depth_jump": JUMP, "load": 0.31}}).values()
    load = trapezoid(1.0, 10, 5, 10, points=100).sample_load
    added = MECHANISMS[KEY].record(load, load, np.zeros_like(load), values)
    assert added == pytest.approx(np.where(np.maximum.accumulate(load) >= 0.31, JUMP, 0.0))


def test_mean_and_covariance_are_those_of_jumps_at_log_normal_loads():
    load = np.linspace(0.15, 0.5, 8)
    values = {"depth_jump": JUMP, "load": LOAD, "scatter": SCATTER}
    own = LOAD * np.exp(SCATTER * np.random.default_rng(1).standard_normal(40000))
    drawn = JUMP * (load >= own[:, None])
    mean = MECHANISMS[KEY].record(load, load, np.zeros_like(load), values)
    assert mean == pytest.approx(drawn.mean(axis=0), abs=0.3)
    covariance = JUMP**2 * MECHANISMS[KEY].course_covariance(load, load, values)
    assert covariance == pytest.approx(np.cov(drawn.T), abs=2.0)


@pytest.mark.parametrize("seed", [1, 2])
def test_jumps_at_loads_of_their_own_are_named(seed):
    """Also beside tests that end below that load."""
    rng = np.random.default_rng(seed)

    def jumped(condition, _):
        reached = np.maximum.accumulate(condition.protocol.sample_load)
        return JUMP * (1.0 + 0.1 * rng.standard_normal()) * (reached >= LOAD * np.exp(SCATTER * rng.standard_normal()))

    found = diagnose(search_of(problem(recordings(rng, jumped)), [*RECORD_ONLY, KEY]), lambda said: None)
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(KEY,)])
    fit = found.accepted[0].fit
    values = fit.model.amplitudes(fit.z)[KEY]
    assert values["depth_jump"] == pytest.approx(JUMP, rel=0.15)
    assert values["load"] == pytest.approx(LOAD, rel=0.2)
