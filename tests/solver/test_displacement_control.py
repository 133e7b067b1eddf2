"""Displacement control: relaxation under cone and sphere, a tip through a spring, scaling, what is not prescribed."""

import numpy as np
import pytest
from relaxing import RelaxationModulus, cone, sphere
from scipy.integrate import quad

from palpate.analytic import hertz, sneddon
from palpate.classical.viscoelastic_depth import Compliance
from palpate.errors import InputError
from palpate.solver.simulation import simulate, simulate_batch
from palpate.study.indenter import Indenter
from palpate.study.protocol import DISPLACEMENT, Protocol, trapezoid
from palpate.study.specification import Specification

LAW = {
    "youngs_modulus": 3.0,
    "poisson_ratio": 0.4999,
    "steady_coefficient": 0.004,
    "steady_exponent": 0.0,
    "transient_coefficient": 0.3,
    "transient_exponent": 0.0,
    "retardation_time": 5.0,
}
INCOMPRESSIBLE = 3 * LAW["youngs_modulus"] / (2 * (1 + LAW["poisson_ratio"]))  # GPa, with the same shear modulus
SOLID = Compliance.of(LAW | {"youngs_modulus": INCOMPRESSIBLE}, 0.5)
SHALLOW, LARGE_SPHERE = Indenter("cone", 88.0), Indenter("sphere", radius=2e5)
RELAXATION = RelaxationModulus.of(SOLID)
TIPS = {"cone": (SHALLOW, *cone(88.0)), "sphere": (LARGE_SPHERE, *sphere(2e5))}
FORMS = {
    "cone": lambda protocol: RELAXATION.load(protocol, *cone(88.0)),
    "sphere": lambda protocol: RELAXATION.load(protocol, *sphere(2e5)),
}


def ramp_and_hold(compliance=0.0, largest=200.0, points=24):
    time = [0.0, 6.0, 24.0]
    samples = np.linspace(0.0, 24.0, points + 1)[1:]
    return Protocol(time, [0.0, largest, largest], samples, DISPLACEMENT, compliance)


def specification(protocol, indenter=SHALLOW, law=(), **more):
    return Specification("nonlinear_burgers", LAW | dict(law), indenter, protocol, **{"kinematics": "small"} | more)


def test_the_relaxation_modulus_inverts_the_compliance():
    """int_0^t J(t - s) Y(s) ds = t."""
    solid = Compliance(0.25 / 1.1, 0.01, ((0.12, 0.5), (0.05, 20.0)))
    modulus = RelaxationModulus.of(solid)
    for t in (0.3, 4.0, 60.0):
        integral = quad(lambda s, t=t: 2.0 * solid.at(t - s) * modulus(np.array(s)), 0.0, t, limit=200)[0]
        assert integral == pytest.approx(t, rel=1e-9)
    assert modulus(np.array(0.0)) == pytest.approx(2.2)


def test_the_closed_forms_begin_elastic():
    protocol = Protocol([0.0, 1e-6], [0.0, 200.0], [1e-6], DISPLACEMENT)
    assert FORMS["cone"](protocol) == pytest.approx(sneddon.load(200.0, INCOMPRESSIBLE, 0.5, 88.0), rel=1e-5)
    assert FORMS["sphere"](protocol) == pytest.approx(hertz.load(200.0, INCOMPRESSIBLE, 0.5, 2e5), rel=1e-5)


@pytest.mark.parametrize("tip", TIPS)
def test_without_a_spring_the_integrated_solution_is_the_closed_form(tip):
    protocol = ramp_and_hold()
    load, depth = RELAXATION.through_spring(protocol, *TIPS[tip][1:])
    assert load == pytest.approx(FORMS[tip](protocol), rel=1e-7)
    assert depth == pytest.approx(protocol.sample_drive)


@pytest.mark.parametrize("tip", TIPS)
def test_relaxation_follows_the_closed_form(tip):
    """Lee & Radok: the load under a given depth, while contact does not shrink."""
    protocol = ramp_and_hold()
    found = simulate(specification(protocol, TIPS[tip][0]))
    assert (found.status, found.quantity) == ("ok", "load")
    assert found.depth == pytest.approx(protocol.sample_drive, rel=1e-9)
    exact = FORMS[tip](protocol)
    assert found.load[2:] == pytest.approx(exact[2:], rel=0.015)
    held = protocol.sample_time >= 6.0
    assert found.load[held] / found.load[held][0] == pytest.approx(exact[held] / exact[held][0], rel=2e-3)


@pytest.mark.parametrize("stiffness", [0.2, 1.0, 5.0])
@pytest.mark.parametrize("tip", TIPS)
def test_a_tip_through_a_spring_follows_the_coupled_solution(tip, stiffness):
    """The spring is softer than the contact, as stiff, and stiffer; in the hold the tip sinks in as the load falls."""
    indenter, factor, exponent = TIPS[tip]
    rigid = FORMS[tip](ramp_and_hold())
    protocol = ramp_and_hold(200.0 / (stiffness * rigid.max()))
    load, depth = RELAXATION.through_spring(protocol, factor, exponent)
    found = simulate(specification(protocol, indenter))
    assert found.load[2:] == pytest.approx(load[2:], rel=0.015)
    assert found.depth[2:] == pytest.approx(depth[2:], rel=0.01)
    assert found.depth + protocol.compliance * found.load == pytest.approx(protocol.sample_drive, rel=1e-7)


def test_loads_go_with_the_square_of_displacements():
    """Under a sharp tip, where the transducer's compliance falls with them."""
    cone = Indenter("cone", 70.3)
    for rate in (0.0, 2e4):
        ramps = [trapezoid(z, 5, 5, 5, 24, DISPLACEMENT, rate / z) for z in (200.0, 500.0)]
        pair = [specification(ramp, cone, kinematics="large", law={"poisson_ratio": 0.4}) for ramp in ramps]
        one, two = (simulate(each) for each in pair)
        assert two.load == pytest.approx(6.25 * one.load, rel=1e-5, abs=1e-9)
        together = simulate_batch(pair)
        assert together[1].load == pytest.approx(two.load, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_the_load_that_made_a_depth_answers_to_it(kinematics):
    """Loading and creep under a given load; then the depth is prescribed."""
    cone = Indenter("cone", 70.3)
    more = {"kinematics": kinematics, "law": {"poisson_ratio": 0.4}}
    pressed = simulate(specification(trapezoid(1.0, 10, 10, 10, 120), cone, **more))
    pushed = pressed.time <= 20.0
    time, depth = np.append(0.0, pressed.time[pushed]), np.append(0.0, pressed.depth[pushed])
    again = simulate(specification(Protocol(time, depth, time[8:], DISPLACEMENT), cone, **more))
    assert again.load == pytest.approx(pressed.load[pushed][7:], rel=0.01)


@pytest.mark.parametrize("law", ["nonlinear_burgers", "bilinear_plasticity"])
def test_beyond_the_residual_depth_the_tip_has_left(law):
    plastic = {"youngs_modulus": 3.0, "poisson_ratio": 0.34, "yield_stress": 0.05, "hardening": 0.2}
    protocol = trapezoid(400.0, 5, 5, 5, 45, DISPLACEMENT, 50.0)
    parameters = LAW if law == "nonlinear_burgers" else plastic
    found = simulate(Specification(law, parameters, Indenter("cone", 70.3), protocol, kinematics="small"))
    away = found.load < 1e-6 * found.load.max()
    assert found.load.min() > -1e-6 * found.load.max()
    assert away[-1]
    assert np.all(np.diff(np.flatnonzero(away)) == 1)
    assert found.depth[away] == pytest.approx(protocol.sample_drive[away], abs=1e-3)


def test_drift_and_frame_change_what_the_body_feels():
    """Recorded depth h + g belongs to the displacement: what is added to the depth is missing from the drive."""
    cone, protocol = Indenter("cone", 70.3), trapezoid(300.0, 6, 6, 6, 36, DISPLACEMENT, 20.0)
    disturbed = {"thermal_drift": {"rate": 1.5}, "frame_compliance": {"compliance": 30.0}}
    found = simulate(specification(protocol, cone, mechanisms=disturbed))
    assert found.depth + 20.0 * found.load == pytest.approx(protocol.sample_drive, abs=1e-4)
    drifting = Protocol([0.0, 6, 12, 18], [0.0, 291.0, 282.0, -27.0], protocol.sample_time, DISPLACEMENT, 50.0)
    felt = simulate(specification(drifting, cone))
    assert found.load == pytest.approx(felt.load, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("kinematics", ["small", "large"])
@pytest.mark.parametrize("offset", [-60.0, 20.0])
def test_a_contact_found_early_or_late_shifts_the_drive(offset, kinematics):
    cone, protocol = Indenter("cone", 70.3), trapezoid(300.0, 6, 6, 6, 36, DISPLACEMENT)
    more = {"law": {"poisson_ratio": 0.4}, "kinematics": kinematics}
    found = simulate(specification(protocol, cone, mechanisms={"zero_offset": {"offset": offset}}, **more))
    assert found.depth == pytest.approx(protocol.sample_drive, abs=1e-6)
    deepest = np.argmax(protocol.sample_drive)
    usual = simulate(specification(protocol, cone, **more))
    assert found.load[deepest] / usual.load[deepest] == pytest.approx((1 - offset / 300.0) ** 2, rel=0.05)


def test_what_displacement_control_cannot_do_is_refused():
    protocol = ramp_and_hold()
    with pytest.raises(InputError, match="not known beforehand"):
        _ = protocol.max_load
    pyramid = Indenter("berkovich", face_angle=65.3)
    with pytest.raises(InputError, match="displacement control"):
        simulate(specification(protocol, pyramid))
