"""Bodies that yield: cones keep to their law, rounded tips to slip lines, and what gives way is a failure."""

from itertools import pairwise

import numpy as np
import pytest
from bodies import STANDARD, depth

from palpate.materials import LAWS
from palpate.solver.axisymmetric.discretisation import step_times, steps_of_samples
from palpate.solver.axisymmetric.fields import Fields
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import run_lanes
from palpate.solver.simulation import simulate
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification
from palpate.study.specimen import Specimen

PLASTIC = LAWS["bilinear_plasticity"]


def test_where_a_body_yields_the_load_grows_little_within_a_step():
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=20)
    times, usual = step_times(protocol, STANDARD, yields=True), step_times(protocol, STANDARD)
    load = protocol.load_at(times)
    assert np.isin(usual, times).all()
    assert (load[1:] / np.maximum(load[:-1], 1e-12)).max() < 1.1251


@pytest.mark.parametrize("beside", [-5e-7, 5e-7])
def test_a_sample_that_rounding_parts_from_a_corner_is_taken_at_the_corner(beside):
    protocol = Protocol(np.array([0.0, 1.0, 1000.0]), np.array([0.0, 1.0, 0.0]), np.array([0.5, 1.0 + beside, 1000.0]))
    times = step_times(protocol, STANDARD)
    assert np.isin(protocol.knot_time[1:], times).all()
    assert times[steps_of_samples(times, protocol)].tolist() == [0.5, 1.0, 1000.0]


@pytest.mark.parametrize("large", [False, True])
def test_a_plastic_cone_keeps_to_its_law_from_the_first_sample(large):
    """Without creep depth / sqrt(load) is constant; with a step from one sample to the next it departs by 3 %."""
    constants = {"youngs_modulus": 3.0, "poisson_ratio": 0.34, "yield_stress": 0.1, "hardening": 0.3}
    plastic = PLASTIC.coefficients(constants)
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=40)
    constant = depth(plastic, protocol, large=large)[:20] / np.sqrt(protocol.sample_load[:20])
    assert np.abs(constant / constant[-1] - 1.0).max() < 0.004


@pytest.mark.parametrize(
    ("modulus", "yield_stress", "hardening", "large"), [(72.0, 3.0, 0.0, False), (70.0, 0.3, 0.07, True)]
)
def test_a_plastic_cone_that_hardly_hardens_keeps_to_its_law(modulus, yield_stress, hardening, large):
    """Under the first node much flows at once; whole iterations run away there."""
    constants = {"youngs_modulus": modulus, "poisson_ratio": 0.3, "yield_stress": yield_stress, "hardening": hardening}
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=60)
    plastic = PLASTIC.coefficients(constants)
    constant = depth(plastic, protocol, large=large)[2:30] / np.sqrt(protocol.sample_load[2:30])
    assert constant == pytest.approx(constant.mean(), rel=0.008)


@pytest.mark.parametrize("large", [False, True])
def test_a_body_without_hardening_unloads_as_one_that_hardly_hardens(large):
    """Its stress never exceeds the yield stress, and yet it has flowed."""
    constants = {"youngs_modulus": 70.0, "poisson_ratio": 0.2, "yield_stress": 5.0}
    protocol = trapezoid(1.0, 10.0, 0.0, 10.0, points=20)
    none, little = (
        depth(PLASTIC.coefficients(constants | {"hardening": h}), protocol, large=large) for h in (0.0, 1e-6)
    )
    assert none == pytest.approx(little, rel=1e-5)


def contact_radius(moment):
    """Return the distance from the axis [um] at which the surface bears half of the median pressure of the contact."""
    mesh, stress = moment.mesh, Fields.of(moment).stress
    surface = mesh.surface[1:]
    places = mesh.nodes[surface, 0] + moment.large * moment.displacement[surface, 0]
    beside = [np.flatnonzero(np.isin(mesh.elements, pair).sum(axis=1) == 2)[0] for pair in pairwise(surface)]
    centre, pressure = 0.5 * (places[1:] + places[:-1]), -stress[beside, :, 1].mean(axis=1)
    half = 0.5 * np.median(pressure[pressure > 0.3 * pressure.max()])
    last = np.flatnonzero(pressure > half)[-1]
    return np.interp(half, pressure[[last + 1, last]], centre[[last + 1, last]])


@pytest.mark.parametrize(
    ("tip", "load", "large"),
    [(Indenter("sphere", radius=1000.0), 0.3, False), (Indenter("sphero_cone", 70.3, 500.0), 3.0, True)],
)
def test_a_solid_that_never_hardens_bears_a_rounded_tip(tip, load, large):
    """Its hardness is two to three times its yield stress, as slip lines have it, and its surface never folds."""
    constants = {"youngs_modulus": 70.0, "poisson_ratio": 0.3, "yield_stress": 0.3, "hardening": 0.0}
    plastic, protocol = PLASTIC.coefficients(constants), trapezoid(load, 10.0, 0.0, 10.0, points=40)
    hardness, stretches = [], []

    def observe(moment):
        surface = moment.mesh.surface
        r, moved = moment.mesh.nodes[surface, 0], moment.displacement[surface, 0]
        stretches.append(1.0 + (np.diff(moved) / np.diff(r)).min())
        if 2.0 < moment.time <= 10.0:
            hardness.append(moment.load / (np.pi * contact_radius(moment) ** 2 * 0.3))

    for case in Case(Specimen(plastic), tip, protocol, STANDARD, large).and_merged:
        hardness.clear()
        stretches.clear()
        (outcome,) = run_lanes([case], observe=observe)
        if not outcome.reason:
            break
    assert outcome.reason == ""
    assert 2.0 < min(hardness) < max(hardness) < 3.0
    assert min(stretches) > 0.0


@pytest.mark.parametrize(
    ("key", "constants", "load"),
    [
        ("bilinear_plasticity", {"youngs_modulus": 10.0, "yield_stress": 0.1, "hardening": 0.05}, 1.0),
        ("elastic", {"youngs_modulus": 1.0}, 5.0),
    ],
)
def test_a_sphere_that_sinks_in_beyond_its_radius_is_a_failure(key, constants, load):
    """At small strains nothing stops it: many radii deep, a curve would look whole."""
    tip, protocol = Indenter("sphere", radius=1000.0), trapezoid(load, 10.0, 0.0, 10.0, points=20)
    outcome = simulate(Specification(key, constants | {"poisson_ratio": 0.3}, tip, protocol, kinematics="small"))
    assert outcome.status == "failed"
    assert "beyond its radius" in outcome.reason
    assert np.isnan(outcome.depth[-1])
    assert np.nanmax(outcome.depth) <= 1000.0


def test_a_sphere_under_which_a_body_gives_way_is_a_failure():
    """It never hardens: the tip falls through by many radii within one step, from where nothing is in equilibrium."""
    constants = {"youngs_modulus": 10.0, "poisson_ratio": 0.3, "yield_stress": 0.1, "hardening": 0.0}
    tip, protocol = Indenter("sphere", radius=1000.0), trapezoid(1.0, 10.0, 0.0, 10.0, points=20)
    outcome = simulate(Specification("bilinear_plasticity", constants, tip, protocol, kinematics="small"))
    assert outcome.status == "failed"
    assert outcome.reason
    assert np.isnan(outcome.depth[-1])
    assert np.nanmax(outcome.depth) <= 1000.0
