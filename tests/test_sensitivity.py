"""Derivatives by direct differentiation against central differences on the same mesh, and against exact laws."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.errors import ConvergenceError, InputError
from palpate.fem import indent as history
from palpate.fem import newton
from palpate.fem.discretisation import mesh_radii
from palpate.fem.mesh import Resolution
from palpate.mechanisms import MECHANISMS
from palpate.model import sensitivities, simulate, specification_from
from palpate.variation import acting
from palpate.verification.materials import BURGERS as EPOXY

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
PROTOCOL = {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 14}
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
        ["film_on_substrate.substrate_modulus", "youngs_modulus"],
    ),
    "size_effect_and_lag": (
        {"size_effect": {"length": 50.0}, "controller_lag": {"lag": 1.0}},
        ["size_effect.length", "controller_lag.lag", "transient_exponent"],
    ),
}


def specification(**changes):
    mechanisms = {key: changes.pop(key) for key in list(changes) if key in MECHANISMS}
    base = {"material": BURGERS, "indenter": CONE, "protocol": PROTOCOL, "mechanisms": mechanisms}
    return specification_from(base | changes)


def radii_of(spec):
    solid = acting(spec)
    return mesh_radii(solid.specimen, solid.indenter, solid.protocol, COARSE)


def at(spec, name, value):
    key, _, own = name.rpartition(".")
    if not key:
        return replace(spec, parameters={**spec.parameters, own: value})
    return replace(spec, mechanisms={**spec.mechanisms, key: {**spec.mechanisms[key], own: value}})


def value_of(spec, name):
    key, _, own = name.rpartition(".")
    return (spec.mechanisms[key] if key else spec.parameters)[own]


@pytest.mark.parametrize("case", CASES)
def test_central_differences_on_the_same_mesh(case, monkeypatch):
    """The forces balance to 1e-11 here, so that their imbalance does not hide in the differences."""
    monkeypatch.setattr(newton, "TOLERANCE", 1e-11)
    changes, names = CASES[case]
    spec = specification(**changes)
    radii = radii_of(spec)
    simulation, derivatives = sensitivities(spec, names, radii)
    assert np.array_equal(simulation.depth, simulate(spec, radii).depth)
    for name, derivative in zip(names, derivatives.T, strict=True):
        value = value_of(spec, name)
        high, low = (simulate(at(spec, name, value * (1 + k * 2e-6)), radii).depth for k in (1, -1))
        difference = (high - low) / (4e-6 * value)
        assert np.abs(derivative - difference).max() < 1e-4 * np.abs(difference).max(), name


def test_friction_begins_at_zero(monkeypatch):
    """A frictionless simulation knows the derivative by friction; one-sided differences of second order."""
    monkeypatch.setattr(newton, "TOLERANCE", 1e-11)
    spec = specification(friction={"coefficient": 0.0})
    derivative = sensitivities(spec, ["friction.coefficient"], radii_of(spec))[1][:, 0]
    none, little, more = (simulate(at(spec, "friction.coefficient", k * 1e-5), radii_of(spec)).depth for k in range(3))
    difference = (4 * little - 3 * none - more) / 2e-5
    assert np.abs(derivative - difference).max() < 1e-4 * np.abs(difference).max()


def test_stresses_scale_and_a_sharp_cone_has_no_length():
    """Derivatives obey the law h(c E, c^-(2m+1) C, c P) = h(E, C, P), with h(c P) = sqrt(c) h(P) for a cone.

    At c = 1:  E dh/dE - sum (2 m + 1) C dh/dC = -h/2. A contact set that stays has a length, so single points scatter
    by some percent on any one mesh; their mean over the loading keeps the law.
    """
    spec = specification(protocol=PROTOCOL | {"points": 70})
    names = ["youngs_modulus", "steady_coefficient", "transient_coefficient"]
    simulation, derivatives = sensitivities(spec, names)
    values = np.array([value_of(spec, name) for name in names])
    powers = np.array([1.0, -(2 * 0.2 + 1), -(2 * 0.47 + 1)])
    loading = simulation.time <= 30.0
    scaled = (derivatives @ (values * powers))[loading]
    assert scaled.sum() == pytest.approx(-0.5 * simulation.depth[loading].sum(), rel=0.02)
    assert scaled == pytest.approx(-0.5 * simulation.depth[loading], rel=0.1)


def test_a_lag_delays_the_curve():
    """A body that does not age responds to a delayed load with a delayed depth: dh/dlag = -dh/dt, on average."""
    protocol = PROTOCOL | {"points": 70}
    spec = specification(controller_lag={"lag": 1.03}, protocol=protocol)
    derivative = sensitivities(spec, ["controller_lag.lag"])[1][:, 0]
    plain = simulate(specification(protocol=protocol))
    loading = (plain.time > 5.0) & (plain.time < 30.0)
    rate = np.interp(plain.time[loading] - 1.03, plain.time, np.gradient(plain.depth, plain.time))
    assert np.mean(-derivative[loading] / rate) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("changes", "name", "message"),
    [
        ({}, "youngs_modulo", "use one of: youngs_modulus"),
        ({}, "thermal_drift.rate", "add the mechanism"),
        ({"thermal_drift": {"rate": 0.1}}, "thermal_drift.rat", "use one of: thermal_drift.rate"),
        (
            {"film_on_substrate": {"thickness": 1500.0, "substrate_modulus": 70.0}},
            "film_on_substrate.thickness",
            "no derivative by the thickness",
        ),
        ({"controller_lag": {"lag": 5.0}}, "controller_lag.lag", "meets a sampling time"),
        ({"controller_lag": {"lag": 0.0}}, "controller_lag.lag", "without a lag"),
    ],
)
def test_what_has_no_derivative_is_refused(changes, name, message):
    with pytest.raises(InputError, match=message) as caught:
        sensitivities(specification(**changes), [name])
    assert caught.value.place == "parameters"


def test_a_failure_leaves_derivatives_unknown(monkeypatch):
    """Both depth and derivatives are NaN from the failure on, and known before it."""
    advance = history.advance

    def stop_half_way(problem, state, time, *rest, **options):
        if time > 35.0:
            raise ConvergenceError("stopped", time=state.time)
        return advance(problem, state, time, *rest, **options)

    monkeypatch.setattr(history, "advance", stop_half_way)
    simulation, derivatives = sensitivities(specification(), ["youngs_modulus"])
    known = simulation.time <= 35.0
    assert simulation.status == "failed"
    assert np.array_equal(np.isfinite(derivatives[:, 0]), known)
    assert np.array_equal(np.isfinite(simulation.depth), known)
