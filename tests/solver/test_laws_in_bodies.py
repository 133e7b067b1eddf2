"""New laws in a film, under a size effect, and in three dimensions."""

from dataclasses import replace

import numpy as np
import pytest
from kernels import hexahedron_at_large_strains, linear_hexahedron
from law_examples import BACKED, values
from under_a_cone import depths, specification

from palpate.materials import law_of
from palpate.materials.flow.point import commit, history, length, residual, solve, state_size
from palpate.materials.flow.row import BACK_STRESS, BULK, SPLIT, STIFFENING, step_weights, voigt_elements
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.law_lanes import Points, commit_and_begin
from palpate.solver.pyramid.linear_3d import Points3D
from palpate.solver.pyramid.mesh_3d import integration

FLOWS = {
    "ludwik_plasticity": {"yield_stress": 0.06, "strength": 0.2, "hardening_exponent": 0.3},
    "eyring": {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1},
}


def with_mechanism(key, flow, **mechanism):
    return replace(specification(key, flow), mechanisms=mechanism)


@pytest.mark.parametrize("key", FLOWS)
def test_a_stiff_substrate_and_a_size_effect_resist(key):
    flow = FLOWS[key]
    film = {"film_on_substrate": {"thickness": 1600.0, "substrate_modulus": 70.0}}
    thicker = {"film_on_substrate": {"thickness": 1700.0, "substrate_modulus": 70.0}}
    bodies = [with_mechanism(key, flow, **film), with_mechanism(key, flow, **thicker)]
    thin, thick = depths(*bodies)
    small, large = depths(*(with_mechanism(key, flow, size_effect={"length": x}) for x in (100.0, 300.0)))
    plain, _ = depths(specification(key, flow), specification(key, flow | {"youngs_modulus": 3.0}))
    assert thin.max() < thick.max() < plain.max()
    assert large.max() < small.max() < plain.max()


ENTERED = pytest.mark.xfail(reason="one change 0.63 off the mean: the interface enters elements under the axis")


@pytest.mark.parametrize("key", [pytest.param(key, marks=ENTERED) if key == "eyring" else key for key in FLOWS])
def test_depth_varies_smoothly_with_the_thickness_of_a_film(key):
    """Elements change with their share of film, so that equal steps of thickness change the depth about equally."""
    thickness = np.linspace(1500.0, 1580.0, 8)
    films = [{"film_on_substrate": {"thickness": t, "substrate_modulus": 70.0}} for t in thickness]
    change = np.diff(depths(*(with_mechanism(key, FLOWS[key], **film) for film in films)).max(axis=1))
    assert np.all(change > 0.0)
    assert np.all(np.abs(change / change.mean() - 1.0) < 0.5)


@pytest.mark.parametrize("model", ["burgers_plasticity", "burgers_plasticity+kinematic_hardening", *BACKED])
def test_lanes_remember_what_points_remember(model):
    """Steps of a turning strain in unequal times: strain, back stress and alpha that the past fixes are the same."""
    rng, law = np.random.default_rng(8), law_of(model).coefficients(values(model))
    rows, count = np.repeat(law[None, :, None], LANES, axis=2), voigt_elements(law)
    points = Points.unloaded(4, count, bool(law[BACK_STRESS]))
    state, past, back, strain = np.zeros(state_size(law, 4)), np.empty(4), np.empty(4), np.zeros(4)
    done = step_weights(rows, 0.5, np.ones(LANES))
    for dt in (0.5, 0.3, 0.9):
        weights = step_weights(rows, dt, np.ones(LANES))
        commit_and_begin(points, rows, done, weights)
        own, done = np.ascontiguousarray(weights[0, :, 0]), weights
        alpha = history(state, own, law, past, back)
        assert points.past[0, :, 0] == pytest.approx(past, rel=1e-9, abs=1e-15)
        assert points.alpha[0, 0] == pytest.approx(alpha, rel=1e-9, abs=1e-15)
        if law[BACK_STRESS]:
            assert points.back[0, :, 0] == pytest.approx(back, rel=1e-9, abs=1e-15)
        change = rng.normal(scale=0.03, size=4)
        strain = strain + change - change[:3].mean() * np.array([1.0, 1.0, 1.0, 0.0])
        trial = residual(strain, past, own)
        rho = length(trial, 4)
        q, _, _ = solve(rho, 0.0, alpha, 0.02, own, law)
        commit(state, trial, back, alpha, q, 0.02, own, law)
        points.rho[:], points.log_q[:], points.secant[:], points.pressure[:] = rho, np.log(q), q / rho, 0.02
        points.direction[:] = trial[:, None] / rho
    assert rho > 0.0 and q > 0.0


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("model", ["ludwik_plasticity", "drucker_prager", "retardation_spectrum", *BACKED])
def test_a_hexahedron_bears_the_stress_of_a_point(model, large):
    """A cube that is squeezed and sheared homogeneously: its forces do the work of the point's stress."""
    law = law_of(model).coefficients(values(model))
    weights = step_weights(law[None], 0.5)[0]
    corners = 0.5 * np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], dtype=float)
    gradients, volumes = (np.ascontiguousarray(part[0]) for part in integration(corners[None]))
    strain = np.diag([0.02, 0.01, -0.05])
    stretch = np.diag(np.exp(np.diag(strain))) - np.eye(3) if large else strain
    u = corners @ stretch
    back = 0.01 * np.array([1.0, -3.0, 2.0, 0.5 * (not large), 0.0, 0.0]) * (weights[STIFFENING] > 0.0)
    points = Points3D(np.zeros((8, 6)), np.tile(back, (8, 1)), np.zeros(8), np.zeros(8), np.empty((8, 6)))
    ke, fe = np.zeros((25, 25)), np.zeros(25)
    arguments = (gradients, volumes, u, points, (weights, law), ke, fe)
    pressure = hexahedron_at_large_strains(*arguments, True) if large else linear_hexahedron(*arguments)
    assert pressure == pytest.approx(-law[BULK] * np.trace(strain))
    deviator = strain - np.trace(strain) / 3 * np.eye(3)
    rho = length(np.array([*np.diag(deviator), 0.0, 0.0, 0.0]), 6)
    q, _, _ = solve(weights[SPLIT] * rho, 0.0, 0.0, pressure, weights, law)
    along = weights[SPLIT] * (q / rho + weights[STIFFENING])
    xx, yy, zz, xy, yz, zx = back
    stress = along * deviator - pressure * np.eye(3) + np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    variation = np.random.default_rng(2).normal(size=(3, 3))
    moved = corners @ (variation @ (np.eye(3) + stretch)).T
    work = np.sum(fe[:24] * moved.ravel())
    volume = np.exp(np.trace(strain)) if large else 1.0
    expected = volume * np.sum(stress * variation) if large else np.sum(stress * (variation @ (np.eye(3) + stretch)))
    assert work == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("model", ["voce_plasticity", "drucker_prager", "eyring+nonlinear_burgers", *BACKED])
def test_the_stiffness_of_a_hexahedron_is_the_symmetric_part_of_the_derivative(model, large):
    """The pressure couples the flow to the volume, which makes the derivative unsymmetric."""
    rng, law = np.random.default_rng(4), law_of(model).coefficients(values(model))
    weights = step_weights(law[None], 0.5)[0]
    corners = 0.5 * np.array([[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], dtype=float)
    gradients, volumes = (np.ascontiguousarray(part[0]) for part in integration(corners[None]))
    u = corners @ np.diag([0.02, 0.02, -0.07]) + 0.005 * rng.standard_normal((8, 3))

    back = 0.01 * rng.standard_normal((8, 6)) * (weights[STIFFENING] > 0.0)
    back[:, :3] -= back[:, :3].mean(axis=1, keepdims=True)

    def forces(u):
        points = Points3D(np.zeros((8, 6)), back, np.zeros(8), np.zeros(8), np.empty((8, 6)))
        ke, fe = np.zeros((25, 25)), np.zeros(25)
        arguments = (gradients, volumes, u, points, (weights, law), ke, fe)
        hexahedron_at_large_strains(*arguments, True) if large else linear_hexahedron(*arguments)
        return fe[:24], ke[:24, :24]

    units = 1e-7 * np.eye(24).reshape(24, 8, 3)
    derivative = np.stack([(forces(u + unit)[0] - forces(u - unit)[0]) / 2e-7 for unit in units], axis=1)
    expected = 0.5 * (derivative + derivative.T)
    assert forces(u)[1] == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    assert (np.abs(derivative - derivative.T).max() > 1e-3 * np.abs(expected).max()) or not law[3]
