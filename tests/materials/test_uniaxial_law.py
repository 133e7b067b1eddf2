"""A law at a point under uniaxial stress, against exact solutions and SciPy's integration of the rate equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from palpate.materials import LAWS, law_of
from palpate.materials.flow.uniaxial import STRAIN, STRESS, response_to

E = 3.0
HOOKE = {"youngs_modulus": E, "poisson_ratio": 0.35}
TIME = np.linspace(0.0, 10.0, 101)
BURGERS = {
    "steady_coefficient": 0.05,
    "steady_exponent": 0.0,
    "transient_coefficient": 0.3,
    "transient_exponent": 0.0,
    "retardation_time": 2.0,
}
MODELS = [*(key for key in LAWS if key != "kinematic_hardening"), "bilinear_plasticity+kinematic_hardening"]
MODELS.append("hardening_eyring+kinematic_hardening+retardation_spectrum")


def row(model, **flow):
    return law_of(model).coefficients(HOOKE | flow)


def example(model):
    return {name: value for key in model.split("+") for name, value in LAWS[key].example.items()}


def test_linear_burgers_creep():
    """Axial strain is two thirds of the deviatoric compliance times the stress, beside sigma / E."""
    creep = response_to(row("nonlinear_burgers", **BURGERS), TIME, np.full(101, 0.03), STRESS)
    compliance = 1.0 / E + 2.0 / 3.0 * (0.05 * TIME + 0.3 * (1.0 - np.exp(-TIME / 2.0)))
    np.testing.assert_allclose(creep, 0.03 * compliance, rtol=1e-12)


def test_maxwell_relaxation():
    """d sigma/dt = -(2/3) E C_s sigma at a constant strain."""
    maxwell = row("nonlinear_burgers", **BURGERS | {"transient_coefficient": 0.0})
    stress = response_to(maxwell, TIME, np.full(101, 0.02), STRAIN)
    np.testing.assert_allclose(stress, E * 0.02 * np.exp(-2.0 / 3.0 * E * 0.05 * TIME), rtol=1e-4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_bilinear_plasticity(sign):
    strain = 0.05 * TIME / 10.0
    stress = response_to(row("bilinear_plasticity", yield_stress=0.05, hardening=0.3), TIME, sign * strain)
    expected = np.where(E * strain < 0.05, E * strain, 0.05 + (strain - 0.05 / E) * E * 0.3 / (E + 0.3))
    np.testing.assert_allclose(stress, sign * expected, rtol=1e-10, atol=1e-15)


def test_kinematic_hardening_lowers_the_yield_stress_of_the_way_back_by_twice_what_it_raised():
    """Bauschinger's effect: reverse flow begins at the stress reached less twice the yield stress."""
    flow = {"yield_stress": 0.05, "hardening": 0.0, "kinematic_modulus": 0.3}
    strain = np.append(np.linspace(0.0, 0.05, 101), np.linspace(0.05, -0.05, 2001)[1:])
    stress = response_to(row("bilinear_plasticity+kinematic_hardening", **flow), np.arange(len(strain)) * 0.1, strain)
    reached, tangent = stress[100], E * 0.3 / (E + 0.3)
    assert reached == pytest.approx(0.05 + (0.05 - 0.05 / E) * tangent)
    back = strain[100] - 0.1 / E
    expected = np.where(strain > back, reached - E * (0.05 - strain), reached - 0.1 - tangent * (back - strain))[101:]
    np.testing.assert_allclose(stress[101:], expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_steady_eyring_flow_with_pressure(sign):
    """The rate r_0 sinh(sigma/sigma_0) exp(mu sigma / (3 sigma_0)) becomes the one prescribed; tension flows easier."""
    flow = {"reference_rate": 1e-6, "eyring_stress": 0.005, "pressure_coefficient": 0.2}
    stress = response_to(row("eyring", **flow), TIME, sign * 1e-2 * TIME)[-1]
    rate = 1e-6 * np.sinh(abs(stress) / 0.005) * np.exp(0.2 * stress / (3.0 * 0.005))
    assert rate == pytest.approx(1e-2, rel=1e-4)


@pytest.mark.parametrize("control", [STRAIN, STRESS])
def test_nonlinear_burgers_in_cycles_against_scipy(control):
    """One Voigt element and steady creep that grow with powers of J2 = sigma^2 / 3."""
    values = LAWS["nonlinear_burgers"].example | {"retardation_time": 2.5}
    c_s, m_s, c_t, m_t, t_eps = values.values()
    size = 0.03 if control == STRAIN else 0.05
    drive = size * np.sin(TIME) + 0.01 * TIME * size

    def creep(stress, retarded):
        square = stress**2 / 3.0
        steady = 2.0 / 3.0 * stress * c_s * square**m_s
        return steady, (2.0 / 3.0 * stress * c_t * square**m_t - retarded) / t_eps

    def rates(time, y):
        index = min(int(time / 0.1), 99)
        slope = (drive[index + 1] - drive[index]) / 0.1
        stress = y[0] if control == STRAIN else np.interp(time, TIME, drive)
        steady, retarded = creep(stress, y[1])
        flowed = steady + retarded
        return [E * (slope - flowed) if control == STRAIN else slope / E + flowed, retarded]

    found = solve_ivp(rates, (0.0, 10.0), [0.0, 0.0], t_eval=TIME, rtol=1e-8, atol=1e-12, max_step=0.05).y[0]
    response = response_to(row("nonlinear_burgers", **values), TIME, drive, control)
    assert np.abs(response - found).max() < 2e-4 * np.abs(found).max()


@pytest.mark.parametrize("model", MODELS)
def test_strain_and_stress_control_are_inverse(model):
    """Through a cycle into compression, with whatever a law's file holds."""
    law, strain = row(model, **example(model)), 0.03 * np.sin(TIME)
    stress = response_to(law, TIME, strain)
    found = response_to(law, TIME, stress, STRESS)
    assert np.abs(stress).max() > 0.02
    assert np.abs(found - strain).max() < 0.02 * 0.03


def test_a_stress_that_a_body_without_hardening_cannot_bear_ends_the_response():
    perfect = row("bilinear_plasticity", yield_stress=0.05, hardening=0.0)
    strain = response_to(perfect, TIME, 0.01 * TIME, STRESS)
    assert np.isfinite(strain[:50]).all() and np.isnan(strain[52:]).all()
