"""The tests that are proposed next: their load histories, and what stays behind when the tip is exchanged."""

import pytest

from palpate.diagnosis.next_test import _of_test, feasible
from palpate.indenters import Indenter
from palpate.model import simulate, specification_from

SPEC = {
    "material": {"model": "elastic", "youngs_modulus": 3.28, "poisson_ratio": 0.34},
    "indenter": {"shape": "cone", "half_angle": 70.3, "friction": 0.1},
    "protocol": {"max_load": 1.0, "loading_time": 10.0, "unloading_time": 10.0, "points": 8},
}


def proposed(indenter):
    return list(feasible(1.0, 10.0, indenter))


def test_every_test_can_be_told_apart_by_its_words():
    tests = proposed(Indenter("cone", 70.3))
    assert len({test.words for test in tests}) == len(tests)
    assert all(test.protocol.max_load == pytest.approx(test.settings["max_load"]) for test in tests)


def test_another_tip_takes_the_old_ones_rounding_along_and_nothing_else():
    (other,) = [test for test in proposed(Indenter("cone", 70.3, friction=0.1)) if test.indenter]
    assert other.words.endswith("with a sphere of 10 um")
    effects = {"tip_rounding": {"radius": 200.0}, "zero_offset": {"offset": 12.0}}
    specification = _of_test(specification_from(SPEC | {"mechanisms": effects}), other)
    assert specification.mechanisms == {"zero_offset": {"offset": 12.0}}
    assert (specification.indenter.shape, specification.indenter.radius) == ("sphere", 10_000.0)
    assert specification.indenter.friction == 0.1
    assert simulate(specification).status == "ok"


def test_a_sphere_is_exchanged_for_a_sharp_tip():
    (other,) = [test for test in proposed(Indenter("sphere", radius=1e4)) if test.indenter]
    assert other.words.endswith("with a Berkovich tip")
    assert other.settings["half_angle"] == 70.3
