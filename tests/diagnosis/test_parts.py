"""The parts of tests: every sample in one half of a segment, and the weights of a mean change."""

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, problem, recordings

from palpate.diagnosis.parts import halves, in_segments, mean_changes, polynomials
from palpate.study.prescribed_segments import by_cycle, segments


@pytest.fixture(scope="module")
def task():
    return problem(recordings(np.random.default_rng(0)))


def test_the_halves_of_all_segments_hold_each_sample_of_their_test_once(task):
    every = np.concatenate([half for *_, half in halves(task)])
    assert sorted(every) == list(range(len(task.mean)))
    ends = np.cumsum([len(each.protocol.sample_time) for each in CONDITIONS])
    for condition, _, places in in_segments(task, segments):
        assert set(np.searchsorted(ends, places, side="right")) == {CONDITIONS.index(condition)}


def test_a_change_by_a_factor_of_the_largest_depth_so_far_is_that_factor_in_every_part(task):
    largest = np.concatenate([np.maximum.accumulate(curve) for curve in task.split(task.mean).values()])
    assert [weights @ (0.003 * largest) for weights in mean_changes(task, task.mean)] == pytest.approx(
        [0.003] * sum(1 for _ in halves(task))
    )


def test_polynomials_describe_a_parabola_over_each_segment_and_nothing_beyond_it(task):
    for (_, _, places), (_, _, columns) in zip(in_segments(task, by_cycle), polynomials(task, by_cycle), strict=True):
        parabola = np.zeros(len(task.mean))
        parabola[places] = 1.0 + 2.0 * np.arange(len(places)) - 0.1 * np.arange(len(places)) ** 2
        fitted = columns @ np.linalg.lstsq(columns, parabola)[0]
        assert fitted == pytest.approx(parabola, abs=1e-9 * np.abs(parabola).max())
