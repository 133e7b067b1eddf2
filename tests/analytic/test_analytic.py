"""Closed forms against their units and contact radii; scaling laws against the solver itself."""

import numpy as np
import pytest

from palpate.analytic import hertz, scaling, sneddon
from palpate.errors import InputError
from palpate.solver.simulation import simulate
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specification import Specification
from studies.verification.reference_materials import BURGERS as EPOXY

LOADS = np.array([1e-3, 0.1, 4.0])
BURGERS = {
    **EPOXY,
    "transient_coefficient_2": 0.1,
    "transient_exponent_2": 0.3,
    "retardation_time_2": 20.0,
    "yield_stress": 0.12,
    "hardening": 0.5,
}


@pytest.mark.parametrize(("form", "length"), [(sneddon, 70.3), (hertz, 1e4)])
def test_load_and_depth_are_inverse(form, length):
    assert form.load(form.depth(LOADS, 3.28, 0.34, length), 3.28, 0.34, length) == pytest.approx(LOADS, rel=1e-12)


def test_units_are_millinewton_and_nanometre():
    """1 GPa um^2 = 1 mN: a cone of 45 degrees, h = 1 um, E = 1 GPa."""
    assert sneddon.load(1e3, 1.0, 0.0, 45.0) == pytest.approx(2 / np.pi)
    assert hertz.load(1e3, 1.0, 0.0, 1e3) == pytest.approx(4 / 3)


def test_sneddon_stiffness_is_that_of_his_contact_radius():
    """dP/dh = 2 E* a for any axisymmetric punch, with a = (2/pi) h tan(alpha)."""
    h, step = 500.0, 1e-3
    stiffness = (sneddon.load(h + step, 3.28, 0.34, 70.3) - sneddon.load(h - step, 3.28, 0.34, 70.3)) / (2 * step)
    radius = 2 / np.pi * h * np.tan(np.radians(70.3))
    assert stiffness == pytest.approx(2e-6 * 3.28 / (1 - 0.34**2) * radius, rel=1e-6)


def test_hertz_stiffness_is_that_of_his_contact_radius():
    h, step = 50.0, 1e-4
    stiffness = (hertz.load(h + step, 3.28, 0.34, 1e4) - hertz.load(h - step, 3.28, 0.34, 1e4)) / (2 * step)
    assert stiffness == pytest.approx(2e-6 * 3.28 / (1 - 0.34**2) * np.sqrt(1e4 * h), rel=1e-6)


def specification(model="burgers_plasticity", values=BURGERS):
    return Specification(
        model, values, Indenter("cone", 70.3), trapezoid(1.0, 30.0, 5.0, 30.0, points=20), kinematics="small"
    )


ELASTIC = {"youngs_modulus": 3.0, "poisson_ratio": 0.3}
EYRING = {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1}
VOCE = {"yield_stress": 0.05, "saturation_stress": 0.15, "saturation_strain": 0.1}
SPECTRUM = {"spectrum_coefficient": 0.02, "spectrum_exponent": 0.2, "shortest_time": 0.3, "longest_time": 30.0}
LUDWIK = {"yield_stress": 0.05, "strength": 0.1, "hardening_exponent": 0.3}


@pytest.mark.parametrize(
    ("model", "values"),
    [
        ("burgers_plasticity", BURGERS),
        ("eyring+voce_plasticity", ELASTIC | EYRING | VOCE),
        ("retardation_spectrum+ludwik_plasticity", ELASTIC | SPECTRUM | LUDWIK | {"elements": 5}),
    ],
)
def test_stress_and_time_scaling_leave_depths_alone(model, values):
    one = simulate(specification(model, values)).depth
    assert simulate(scaling.stress_scaled(specification(model, values), 3.0)).depth == pytest.approx(one, rel=1e-6)
    assert simulate(scaling.time_scaled(specification(model, values), 7.0)).depth == pytest.approx(one, rel=1e-6)


def test_load_scaling_is_a_square_root_and_needs_a_sharp_cone():
    other, ratio = scaling.load_scaled(specification(), 4.0)
    assert ratio == 2.0
    assert other.protocol.max_load == 4.0
    with pytest.raises(InputError, match="length"):
        scaling.load_scaled(
            Specification(
                "elastic",
                {"youngs_modulus": 3.0, "poisson_ratio": 0.3},
                Indenter("sphere", 0.0, 1e4),
                other.protocol,
                kinematics="small",
            ),
            2.0,
        )
