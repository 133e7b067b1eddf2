"""Derivatives of the curve against central differences on the same mesh, and against exact laws."""

import numpy as np
import pytest
from derivatives import at, sensitivities, sensitivities_batch, value_of

from palpate.mechanisms import MECHANISMS
from palpate.solver.axisymmetric import march, newton
from palpate.solver.axisymmetric.discretisation import mesh_radii
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.simulation import simulate, specification_from
from palpate.solver.variation import applied_to_body
from studies.verification.reference_materials import BURGERS as EPOXY

BURGERS = {"model": "nonlinear_burgers", **EPOXY}
SECOND = {"transient_coefficient_2": 0.1, "transient_exponent_2": 0.3, "retardation_time_2": 10.0}
ALUMINIUM = {
    "model": "bilinear_plasticity",
    "youngs_modulus": 70.0,
    "poisson_ratio": 0.345,
    "yield_stress": 0.1,
    "hardening": 0.5,
}
CONE = {"shape": "cone", "half_angle": 70.3}
COARSE = Resolution(growth=1.25, sectors=8, far=200.0)
FINER = Resolution(growth=1.15, sectors=6, far=200.0)  # for friction: on the coarse one 3.7e-3 at the second sample
PROTOCOL = {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 14}
RELEASED = {"drive": "displacement", "max_displacement": 400.0, "spring": 0.1, "loading_time": 10, "hold_time": 5}
CASES = {
    "burgers": ({"material": BURGERS | SECOND}, [*BURGERS, *SECOND][1:]),
    "large_strain": ({"material": BURGERS, "kinematics": "large"}, ["youngs_modulus", "steady_exponent"]),
    "plasticity": ({"material": ALUMINIUM}, [*ALUMINIUM][1:]),
    "instrument": (
        {"thermal_drift": {"rate": 0.1}, "frame_compliance": {"compliance": 5.0}, "zero_offset": {"offset": 4.0}},
        ["thermal_drift.rate", "frame_compliance.compliance", "zero_offset.offset"],
    ),
    "creep_and_yield": (
        {
            "second_voigt": {"coefficient": 0.1, "exponent": 0.3, "retardation_time": 10.0},
            "plastic_yield": {"yield_stress": 0.15, "hardening": 0.2},
        },
        ["second_voigt.coefficient", "plastic_yield.yield_stress", "plastic_yield.hardening"],
    ),
    "tip_and_friction": (
        {
            "tip_angle": {"half_angle": 70.0},
            "tip_rounding": {"radius": 200.0},
            "friction": {"coefficient": 0.2},
            "kinematics": "large",
        },
        ["tip_angle.half_angle", "tip_rounding.radius", "friction.coefficient", "poisson_ratio"],
    ),
    "film": (
        {"film_on_substrate": {"thickness": 1500.0, "substrate_modulus": 70.0}},
        ["film_on_substrate.thickness", "film_on_substrate.substrate_modulus", "youngs_modulus"],
    ),
    "adhesion": ({"adhesion": {"work": 200.0}}, ["adhesion.work", "youngs_modulus"]),
    "released": (
        {
            "protocol": RELEASED | {"unloading_time": 10, "points": 25},
            "size_effect": {"length": 20.0},
            "frame_compliance": {"compliance": 5.0},
        },
        ["size_effect.length"],
    ),
    "size_effect_and_lag": (
        {"size_effect": {"length": 50.0}, "controller_lag": {"lag": 1.0}},
        ["size_effect.length", "controller_lag.lag", "transient_exponent"],
    ),
}


def specification(**changes):
    mechanisms = {key: changes.pop(key) for key in list(changes) if key in MECHANISMS}
    base = {
        "material": BURGERS,
        "indenter": CONE,
        "protocol": PROTOCOL,
        "mechanisms": mechanisms,
        "kinematics": "small",
    }
    return specification_from(base | changes)


def radii_of(spec, resolution=COARSE):
    solid = applied_to_body(spec)
    return mesh_radii(solid.specimen, solid.indenter, solid.protocol, resolution)


RELEASE = pytest.mark.xfail(reason="5.3e-3 at the last sample before the tip leaves; at most 9e-4 before")


@pytest.mark.parametrize("case", [pytest.param(case, marks=RELEASE) if case == "released" else case for case in CASES])
def test_central_differences_on_the_same_mesh(case):
    """Differences over 0.06 % of the value, whose error is of second order.

    Each simulation of a difference divides its steps by itself; a neighbour keeps those of its host.
    """
    changes, names = CASES[case]
    spec = specification(**changes)
    radii = radii_of(spec, FINER if case == "tip_and_friction" else COARSE)
    simulation, derivatives = sensitivities(spec, names, radii)
    assert simulation.response == pytest.approx(simulate(spec, radii).response, rel=1e-5, abs=1e-9)
    for name, derivative in zip(names, derivatives.T, strict=True):
        value = value_of(spec, name)
        step = 3e-4 * value
        high, low = (simulate(at(spec, name, value + k * step), radii).response for k in (1, -1))
        difference = (high - low) / (2 * step)
        assert np.abs(derivative - difference).max() < 2e-3 * np.abs(difference).max(), name


def test_several_indentations_know_their_derivatives_in_one_call():
    specs = [specification(), specification(material=BURGERS | {"youngs_modulus": 2.5})]
    for alone, (simulation, derivatives) in zip(specs, sensitivities_batch(specs, ["poisson_ratio"]), strict=True):
        single, column = sensitivities(alone, ["poisson_ratio"])
        assert simulation.depth == pytest.approx(single.depth, rel=1e-8)
        assert derivatives == pytest.approx(column, rel=1e-4, abs=1e-4 * np.abs(column).max())


def test_parameters_share_out_the_lanes_that_few_indentations_leave():
    """Two indentations leave three lanes to each beside its own; eight leave none."""
    specs = [specification(material=BURGERS | {"youngs_modulus": 2.5 + 0.25 * k}) for k in range(8)]
    names = [*BURGERS][1:6]
    many, few = (sensitivities_batch(chosen, names)[1][1] for chosen in (specs, specs[:2]))
    assert few == pytest.approx(many, rel=1e-6, abs=1e-6 * np.abs(many).max())


def test_friction_begins_at_zero():
    """A frictionless simulation knows the derivative by friction; one-sided differences of second order."""
    spec = specification(friction={"coefficient": 0.0})
    derivative = sensitivities(spec, ["friction.coefficient"], radii_of(spec))[1][:, 0]
    none, little, more = (simulate(at(spec, "friction.coefficient", k * 1e-3), radii_of(spec)).depth for k in range(3))
    difference = (4 * little - 3 * none - more) / 2e-3
    assert np.abs(derivative - difference).max() < 0.1 * np.abs(difference).max()


def test_stresses_scale_and_a_sharp_cone_has_no_length():
    """Derivatives obey the law h(c E, c^-(2m+1) C, c P) = h(E, C, P), with h(c P) = sqrt(c) h(P) for a cone.

    At c = 1:  E dh/dE - sum (2 m + 1) C dh/dC = -h/2.
    """
    spec = specification(protocol=PROTOCOL | {"points": 70})
    names = ["youngs_modulus", "steady_coefficient", "transient_coefficient"]
    simulation, derivatives = sensitivities(spec, names)
    values = np.array([value_of(spec, name) for name in names])
    powers = np.array([1.0, -(2 * 0.2 + 1), -(2 * 0.47 + 1)])
    loading = (simulation.time >= 3.0) & (simulation.time <= 30.0)
    scaled = (derivatives @ (values * powers))[loading]
    assert scaled == pytest.approx(-0.5 * simulation.depth[loading], rel=2e-3)


def test_a_lag_delays_the_curve():
    """A body that does not age responds to a delayed load with a delayed depth: dh/dlag = -dh/dt."""
    protocol = PROTOCOL | {"points": 70}
    spec = specification(controller_lag={"lag": 1.03}, protocol=protocol)
    derivative = sensitivities(spec, ["controller_lag.lag"])[1][:, 0]
    plain = simulate(specification(protocol=protocol))
    loading = (plain.time > 5.0) & (plain.time < 30.0)
    rate = np.interp(plain.time[loading] - 1.03, plain.time, np.gradient(plain.depth, plain.time))
    assert -derivative[loading] / rate == pytest.approx(1.0, abs=0.02)


def test_a_failure_leaves_derivatives_unknown(monkeypatch):
    """Both depth and derivatives are NaN from the failure on, and known before it."""
    spec = specification()
    monkeypatch.setattr(march, "advance", losing_from(12))
    simulation, derivatives = sensitivities(spec, ["youngs_modulus"])
    known = np.isfinite(simulation.depth)
    assert simulation.status == "failed"
    assert known.any() and not known.all()
    assert np.array_equal(np.isfinite(derivatives[:, 0]), known)


def losing_from(step):
    """Return `advance` of a march that finds no equilibrium from some step on."""
    taken = [0]

    def advance(*arguments):
        newton.advance(*arguments)
        taken[0] += 1
        if taken[0] >= step:
            arguments[-1][:] = False

    return advance
