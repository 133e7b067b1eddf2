"""Indentations that differ in size alone: simulated once, and only where no length tells them apart."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.indenters import Indenter
from palpate.model import simulate, simulate_batch
from palpate.protocol import trapezoid
from palpate.specification import Specification

EPOXY = {
    "youngs_modulus": 3.0,
    "poisson_ratio": 0.34,
    "steady_coefficient": 0.05,
    "steady_exponent": 0.2,
    "transient_coefficient": 0.2,
    "transient_exponent": 0.3,
    "retardation_time": 0.25,
}
CONE = Indenter("cone", half_angle=70.3)


def under(load, hold=5.0, **changes):
    specification = Specification("nonlinear_burgers", EPOXY, CONE, trapezoid(load, 10, hold, 10, points=20))
    return replace(specification, **changes)


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_a_curve_at_another_load_is_the_same_but_for_its_size(simulated, kinematics):
    specifications = [under(load, kinematics=kinematics) for load in (1.0, 0.1, 25.0)]
    found = simulate_batch(specifications)
    assert simulated == [1]
    for specification, outcome in zip(specifications, found, strict=True):
        assert outcome.depth == pytest.approx(simulate(specification).depth, rel=1e-9)


def test_what_the_instrument_adds_is_its_own_at_each_load(simulated):
    stiff, soft = under(1.0), under(4.0, mechanisms={"frame_compliance": {"compliance": 0.5}})
    first, second = simulate_batch([stiff, soft])
    assert simulated == [1]
    assert second.depth == pytest.approx(2.0 * first.depth + 0.5 * second.load, rel=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"indenter": Indenter("sphere", radius=5000.0)},
        {"mechanisms": {"film_on_substrate": {"thickness": 5000.0, "substrate_modulus": 30.0}}},
        {"mechanisms": {"size_effect": {"length": 100.0}}},
        {"hold": 6.0},
    ],
)
def test_a_length_or_another_time_makes_another_curve(simulated, changes):
    simulate_batch([under(1.0), under(1.0, **changes), under(2.0, **changes)])
    assert simulated == [3 if "hold" not in changes else 2]


def test_loads_out_of_proportion_make_another_curve(simulated):
    slower = replace(under(1.0), protocol=trapezoid(1.0, 10, 5, 20, points=20))
    assert len(simulate_batch([under(1.0), slower])) == 2
    assert simulated == [2]
    assert not np.allclose(*(outcome.depth for outcome in simulate_batch([under(1.0), slower])))
