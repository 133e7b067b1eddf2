"""Indentations that differ in size alone: simulated once, and only where no length tells them apart."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.similar import indent_distinct, length_ratio
from palpate.solver.simulation import simulate, simulate_batch
from palpate.solver.variation import applied_to_body
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specification import Specification

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
    specification = Specification(
        "nonlinear_burgers", EPOXY, CONE, trapezoid(load, 10, hold, 10, points=20), kinematics="small"
    )
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


def case(load, **changes):
    solid = applied_to_body(under(load, **changes))
    large = solid.kinematics == "large"
    return Case(solid.specimen, solid.indenter, solid.protocol, RESOLUTIONS["standard"], large)


SOFTER = {"parameters": EPOXY | {"youngs_modulus": 2.9997}}
BLUNTER = {"indenter": Indenter("cone", half_angle=70.307)}


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_neighbours_are_solved_once_where_cases_differ_in_size_alone(simulated, kinematics):
    """And derivatives are those of cases that are solved each by itself."""
    cases = [case(load, kinematics=kinematics) for load in (1.0, 4.0)]
    perturbed = [[case(load, kinematics=kinematics, **change) for change in (SOFTER, BLUNTER)] for load in (1.0, 4.0)]
    found = indent_distinct(cases, perturbed)
    assert simulated == [1]
    for shared, alone in zip(found, indent_batch(cases, perturbed), strict=True):
        assert shared.depth == pytest.approx(alone.depth, rel=1e-9)
        changes = [history.perturbed_depths - history.depth for history in (shared, alone)]
        assert changes[0] == pytest.approx(changes[1], rel=1e-6, abs=1e-6 * np.abs(changes[1]).max())
        assert np.all(np.abs(changes[1]).max(axis=1) > 1e-3), "both are felt"


def rounded(radius):
    return {"mechanisms": {"tip_rounding": {"radius": radius}}}


def filmed(thickness):
    return {"mechanisms": {"film_on_substrate": {"thickness": thickness, "substrate_modulus": 30.0}}}


@pytest.mark.parametrize(
    ("own", "other"),
    [
        ({}, rounded(1.0)),
        ({}, {"mechanisms": {"size_effect": {"length": 1.0}}}),
        (rounded(100.0), rounded(100.003)),
        (filmed(5000.0), filmed(5000.15)),
    ],
)
def test_neighbours_with_a_length_are_solved_for_each_size(simulated, own, other):
    cases = [case(load, **own) for load in (1.0, 4.0)]
    perturbed = [[case(load, **other)] for load in (1.0, 4.0)]
    found = indent_distinct(cases, perturbed)
    assert simulated == [2]
    for number, history in enumerate(found):
        (alone,) = indent_batch(cases[number : number + 1], perturbed[number : number + 1])
        assert history.perturbed_depths == pytest.approx(alone.perturbed_depths, rel=1e-9, nan_ok=True)


def test_given_rings_do_not_grow_with_the_contact():
    sizes = [case(load) for load in (1.0, 4.0)]
    assert length_ratio(*sizes) == pytest.approx(0.5)
    assert length_ratio(*(replace(each, rings=sizes[0].radii) for each in sizes)) is None


def test_neighbours_that_differ_otherwise_are_solved_for_each_case(simulated):
    cases = [case(load) for load in (1.0, 4.0)]
    indent_distinct(cases, [[case(1.0, **SOFTER)], [case(4.0, **BLUNTER)]])
    assert simulated == [2]
