"""What may hide behind an explanation, in corners of what a study can state."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, SCALE, fitted, problem, recordings

from palpate.diagnosis.screen import Screen
from palpate.diagnosis.undetected import joint_intervals
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.mechanisms import MECHANISMS

FRAME = "frame_compliance.compliance"


@pytest.fixture(scope="module")
def task():
    return problem(recordings(np.random.default_rng(1)))


def half(row):
    return 0.5 * (row["upper"] - row["lower"])


def all_acting(fit, keys=RECORD_ONLY):
    return joint_intervals(fit, Screen.of(fit, keys))


def test_a_range_that_ends_at_zero_is_as_large_as_it_is_long(task):
    below, above = (
        replace(task, scale=replace(SCALE, stated={"thermal_drift": {"rate": rates}}))
        for rates in ([-0.5, 0], [0, 0.5])
    )
    found = [all_acting(fitted(each))["thermal_drift.rate"] for each in (below, above)]
    assert half(found[0]) == pytest.approx(half(found[1]))


def test_a_tip_of_another_angle_joins_though_the_middle_of_its_range_is_the_base_model(task):
    """Here its effect is that of a frame, and its sign changes in the middle of the range."""
    angles = MECHANISMS["tip_angle"].searched(SCALE)["half_angle"]

    def like_a_frame(protocol, values):
        place = (values["half_angle"] - angles.lower) / (angles.upper - angles.lower)
        return 50.0 * (place - 0.5) * protocol.sample_load

    fit = fitted(problem(task.observed, tip_angle=like_a_frame))
    alone, joined = (all_acting(fit, keys)[FRAME] for keys in (RECORD_ONLY, [*RECORD_ONLY, "tip_angle"]))
    assert half(joined) > 2.0 * half(alone)


def test_a_law_that_is_void_when_all_act_is_silent_whether_its_effect_is_named_or_not(task):
    law = AmplitudeConstraint("frame_compliance", "compliance", 0.0, -0.1, 0.1, "tops", ("zero_offset",))
    for named in ((), ("frame_compliance",)):
        fit = replace(fitted(task, named), constraints=(law,))
        without = all_acting(replace(fit, constraints=()))[FRAME]
        assert half(all_acting(fit)[FRAME]) == pytest.approx(half(without), rel=1e-6)
