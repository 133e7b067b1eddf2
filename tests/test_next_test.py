"""The tests that are proposed next: their load histories, and what stays behind when the tip is exchanged."""

from pathlib import Path

import numpy as np
import pytest
from test_diagnosis import fitted, problem, recordings

from palpate.configuration.study_file import load_study
from palpate.diagnosis.next_test import _of_test, error_of_means, feasible
from palpate.solver.simulation import simulate, specification_from
from palpate.study.indenter import Indenter

CHALLENGE = Path(__file__).parents[1] / "config" / "challenge.yaml"
SPEC = {
    "material": {"model": "elastic", "youngs_modulus": 3.28, "poisson_ratio": 0.34},
    "indenter": {"shape": "cone", "half_angle": 70.3, "friction": 0.1},
    "protocol": {"max_load": 1.0, "loading_time": 10.0, "unloading_time": 10.0, "points": 8},
}

DRIFT = ("thermal_drift",)


def proposed(indenter):
    return list(feasible(1.0, 10.0, indenter))


def test_every_test_can_be_told_apart_by_its_words():
    tests = proposed(Indenter("cone", 70.3))
    assert len({test.phrase for test in tests}) == len(tests)
    assert all(test.protocol.max_load == pytest.approx(test.settings["max_load"]) for test in tests)


def test_another_tip_takes_the_old_ones_rounding_along_and_nothing_else():
    (other,) = [test for test in proposed(Indenter("cone", 70.3, friction=0.1)) if test.indenter]
    assert other.phrase.endswith("with a sphere of 10 um")
    effects = {"tip_rounding": {"radius": 200.0}, "zero_offset": {"offset": 12.0}}
    specification = _of_test(specification_from(SPEC | {"mechanisms": effects}), other)
    assert specification.mechanisms == {"zero_offset": {"offset": 12.0}}
    assert (specification.indenter.shape, specification.indenter.radius) == ("sphere", 10_000.0)
    assert specification.indenter.friction == 0.1
    assert simulate(specification).status == "ok"


def test_a_pyramid_is_exchanged_for_a_sphere():
    (other,) = [test for test in proposed(Indenter.from_mapping({"shape": "berkovich"})) if test.indenter]
    assert other.phrase.endswith("with a sphere of 10 um")
    assert other.indenter == Indenter("sphere", radius=1e4)


def test_a_sphere_is_exchanged_for_a_sharp_tip():
    (other,) = [test for test in proposed(Indenter("sphere", radius=1e4)) if test.indenter]
    assert other.phrase.endswith("with a Berkovich tip")
    assert other.settings["half_angle"] == 70.3


def next_hold():
    """Return the test with a long hold, as a condition, and a curve under it."""
    (hold,) = [test for test in proposed(Indenter("cone", 70.3)) if test.phrase.startswith("a hold of 100 s at 1 mN")]
    return hold.condition, 500.0 * np.sqrt(hold.protocol.sample_load)


def test_a_drift_has_another_rate_in_the_next_test():
    """Rates scatter by 0.3 nm/s, so the mean of three recordings of two minutes is open by 20 nm, and not by 2."""
    rates = np.random.default_rng(3).normal(0.3, 0.2, size=4 * 3)
    drifting = recordings(
        np.random.default_rng(1), lambda c, r: rates["abcd".index(c.name) * 3 + r] * c.protocol.sample_time
    )
    condition, curve = next_hold()
    covariance = error_of_means(load_study(CHALLENGE), fitted(problem(drifting), DRIFT), condition, curve)
    end = condition.protocol.sample_time[-1]
    assert np.sqrt(covariance[-1, -1]) == pytest.approx(0.3 * end / np.sqrt(3), rel=0.1)
