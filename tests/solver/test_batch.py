"""Lanes: their arithmetic, their linear solver, and that no indentation depends on those beside it."""

from dataclasses import replace

import numpy as np
import pytest
from kernels import contact_forces, fit, no_coupling, penetration, profile_at, solve, solve_again, width_of
from numba import njit
from scipy.linalg import solveh_banded
from scipy.stats import norm

from palpate.materials import LAWS
from palpate.solver.axisymmetric import march, march_cases, newton
from palpate.solver.axisymmetric.banded import PANEL
from palpate.solver.axisymmetric.bordered import System
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.lanes import LANES, exponential, load, log_of_one_plus, store
from palpate.solver.axisymmetric.mesh import polar_mesh
from palpate.solver.simulation import simulate, simulate_batch, specification_from
from palpate.solver.variation import applied_to_body
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS as EPOXY

BURGERS = {"model": "nonlinear_burgers", **EPOXY}
TEST = {"max_load": 1.0, "loading_time": 30.0, "unloading_time": 30.0, "points": 20}
CONE = {"shape": "cone", "half_angle": 70.3}


def specification(material=None, indenter=None, protocol=None, **keys):
    values = {
        "material": BURGERS | (material or {}),
        "indenter": CONE | (indenter or {}),
        "protocol": TEST | (protocol or {}),
        "kinematics": "small",
    }
    return specification_from(values | keys)


def case(**changes):
    specimen = Specimen(LAWS["nonlinear_burgers"].coefficients({k: v for k, v in BURGERS.items() if k != "model"}))
    values = {"specimen": specimen, "indenter": Indenter("cone", 70.3), "protocol": trapezoid(1.0, 30.0, 0.0, 30.0, 20)}
    return Case(**(values | {"resolution": RESOLUTIONS["standard"]} | changes))


@njit
def powers_of_e(x, out):
    for i in range(len(x)):
        store(out, i, exponential(load(x, i)))


@njit
def logarithms(x, out):
    for i in range(len(x)):
        store(out, i, log_of_one_plus(load(x, i)))


def test_exponential_is_exact_to_rounding():
    x = np.linspace(-700.0, 700.0, 1000 * LANES).reshape(-1, LANES)
    out = np.empty_like(x)
    powers_of_e(x, out)
    assert np.abs(out / np.exp(x) - 1.0).max() < 5e-16


def test_logarithm_is_exact_to_rounding():
    x = np.concatenate([np.linspace(-0.99, 30.0, 500 * LANES), np.geomspace(1e-18, 1.0, 500 * LANES)])
    x = np.concatenate([x, -np.geomspace(1e-18, 0.9, 500 * LANES)]).reshape(-1, LANES)
    out = np.empty_like(x)
    logarithms(x, out)
    assert np.abs(out - np.log1p(x)).max() < 1e-15
    assert np.abs(out / np.log1p(x) - 1.0).max() < 5e-15


@pytest.mark.parametrize("size", [3, 60, 61, 62, 63])
def test_banded_solution_is_that_of_lapack(size):
    rng = np.random.default_rng(size)
    reach = min(5, size - 1)
    band, right = np.zeros((size * (reach + PANEL), LANES)), rng.normal(size=(2, size, LANES))
    lower = rng.normal(size=(reach + 1, size, LANES))
    lower[0] += 20.0
    for i in range(reach + 1):
        lower[i, size - i :] = 0.0
        band[i :: reach + PANEL] = lower[i]
    first, second = right.copy()
    solve(band, np.empty((0, LANES)), size, reach + PANEL, first, second)
    again = right[0].copy()
    solve_again(band, np.empty((0, LANES)), size, reach + PANEL, again)
    for lane in range(LANES):
        expected = solveh_banded(lower[:, :, lane], right[:, :, lane].T, lower=True)
        np.testing.assert_allclose(np.column_stack([first[:, lane], second[:, lane]]), expected, atol=1e-14)
        np.testing.assert_allclose(again[:, lane], expected[:, 0], atol=1e-14)


@pytest.mark.parametrize("size", [3, 60, 61, 62, 63])
def test_solution_with_an_unsymmetric_matrix_is_that_of_lapack(size):
    rng = np.random.default_rng(size)
    reach = min(5, size - 1)
    rows, columns = np.mgrid[:size, :size]
    within = np.abs(rows - columns) <= reach
    matrices = np.where(within, rng.normal(size=(LANES, size, size)), 0.0) + 20.0 * np.eye(size)
    lower, upper = np.zeros((2, size * (reach + PANEL), LANES))
    for i, j in np.argwhere(np.tril(within)):
        lower[j * (reach + PANEL) + i - j] = matrices[:, i, j]
        upper[j * (reach + PANEL) + i - j] = matrices[:, j, i]
    right = rng.normal(size=(2, size, LANES))
    first, second = right.copy()
    solve(lower, upper, size, reach + PANEL, first, second)
    again = right[0].copy()
    solve_again(lower, upper, size, reach + PANEL, again)
    for lane in range(LANES):
        expected = np.linalg.solve(matrices[lane], right[:, :, lane].T)
        np.testing.assert_allclose(np.column_stack([first[:, lane], second[:, lane]]), expected, atol=1e-14)
        np.testing.assert_allclose(again[:, lane], expected[:, 0], atol=1e-14)


def test_a_matrix_that_is_not_positive_definite_spoils_its_own_lane_alone():
    matrix = np.zeros((12 * (1 + PANEL), LANES))
    matrix[:: 1 + PANEL] = 2.0
    matrix[4 * (1 + PANEL), 1] = -2.0
    first, second = np.ones((2, 12, LANES))
    solve(matrix, np.empty((0, LANES)), 12, 1 + PANEL, first, second)
    assert np.isnan(first[:, 1]).any()
    assert np.delete(first, 1, axis=1) == pytest.approx(0.5)


def test_friction_and_its_absence_do_not_share_lanes():
    curves = [r.depth for r in simulate_batch([specification(indenter={"friction": mu}) for mu in (0.0, 0.4) * 2])]
    assert np.array_equal(curves[0], curves[2]) and np.array_equal(curves[1], curves[3])
    assert curves[1][-1] < 0.99 * curves[0][-1]


def assert_as_alone(specifications, within=0.0):
    """Within is for those that differ in size alone, of which one is simulated and the others are scaled."""
    for together, spec in zip(simulate_batch(specifications), specifications, strict=True):
        alone = simulate(spec)
        assert (together.status, together.reason) == (alone.status, alone.reason)
        assert np.abs(together.depth - alone.depth).max() <= within * alone.depth.max()


def assert_cases_as_alone(cases):
    assert len({each.kind for each in cases}) == 1
    for together, each in zip(march_cases.indent_batch(cases), cases, strict=True):
        (alone,) = march_cases.indent_batch([each])
        assert together.reason == alone.reason == ""
        assert np.array_equal(together.depth, alone.depth, equal_nan=True)


def test_curves_across_the_grid_are_those_of_a_batch_of_one():
    grid = [
        {"youngs_modulus": E, "steady_coefficient": c_s, "steady_exponent": m_s, "transient_exponent": m_t}
        for E, c_s, m_s, m_t in [
            (3.0, 0.02, 0.35, 0.2),
            (3.5, 0.1, 0.15, 0.8),
            (3.0, 0.1, 0.35, 0.8),
            (3.25, 0.0, 0.2, 0.0),
        ]
    ]
    assert_as_alone([specification(material) for material in grid])


def test_angles_loads_and_durations_may_differ_between_lanes():
    assert_as_alone(
        [
            specification(),
            specification(indenter={"half_angle": 65.0}),
            specification(protocol={"max_load": 0.5}),
            specification(protocol={"loading_time": 45.0, "unloading_time": 45.0}),
        ],
        within=1e-9,
    )


def test_holds_elastic_bodies_and_several_voigt_elements():
    second = {"transient_coefficient_2": 0.1, "transient_exponent_2": 0.3, "retardation_time_2": 8.0}
    hold = {"protocol": {"hold_time": 10.0}}
    elastic = {"material": {"model": "elastic", "youngs_modulus": 2.0, "poisson_ratio": 0.45}, "indenter": CONE}
    assert_as_alone([specification(second | {"youngs_modulus": E}, **hold) for E in (3.0, 3.5)])
    loads = [specification_from(elastic | {"protocol": TEST | {"max_load": P}}) for P in (1.0, 3.0)]
    assert_as_alone(loads, within=1e-9)


def test_large_strains_and_other_angles():
    flows = [(0.02, 0.35), (0.1, 0.15), (0.0, 0.2)]
    grid = [{"steady_coefficient": c_s, "steady_exponent": m_s} for c_s, m_s in flows]
    blunt = specification(indenter={"half_angle": 75.0}, kinematics="large")
    assert_as_alone([*(specification(material, kinematics="large") for material in grid), blunt])


def test_size_effects_of_other_lengths():
    lengths = (50.0, 200.0)
    assert_as_alone(
        [specification(kinematics="large", mechanisms={"size_effect": {"length": length}}) for length in lengths]
    )


def test_small_and_large_strains_do_not_share_lanes():
    curves = [r.depth for r in simulate_batch([specification(kinematics=k) for k in ("small", "large") * 2])]
    assert np.array_equal(curves[0], curves[2]) and np.array_equal(curves[1], curves[3])
    assert curves[1][-1] < 0.99 * curves[0][-1]


def test_mechanisms_act_in_a_batch():
    mechanisms = {"tip_angle": {"half_angle": 69.0}, "thermal_drift": {"rate": 0.1}, "controller_lag": {"lag": 0.5}}
    assert_as_alone([specification(mechanisms={key: value}) for key, value in mechanisms.items()])


def test_lanes_may_have_their_corners_at_different_steps():
    """Samples lie 3 s apart: one delayed load turns before the first sample after the peak, the other behind it.

    Both act for 0.1 s on the first sample that they reach, so that their meshes are alike.
    """
    specs = [specification(mechanisms={"controller_lag": {"lag": lag}}) for lag in (2.9, 5.9)]
    cases = [case(protocol=applied_to_body(spec).protocol) for spec in specs]
    assert cases[0].kind == cases[1].kind
    assert not np.array_equal(cases[0].carries, cases[1].carries)
    assert_cases_as_alone(cases)


def test_lanes_may_take_different_numbers_of_steps():
    protocols = [trapezoid(1.0, 30.0, hold, 30.0, points) for hold, points in ((0.0, 20), (10.0, 24), (5.0, 21))]
    cases = [case(protocol=protocol) for protocol in protocols]
    assert len({len(each.times) for each in cases}) == 3
    assert_cases_as_alone(cases)


def test_nothing_happens_before_a_load_acts():
    lagging = specification(mechanisms={"controller_lag": {"lag": 5.0}})
    found = simulate(lagging)
    assert np.all(found.depth[found.time < 5.0] == 0.0)
    assert np.all(found.depth[found.time > 5.0] > 0.0)


PLASTIC = {"model": "burgers_plasticity", "yield_stress": 0.4, "hardening": 0.5}
SPHERE = {"shape": "sphere", "half_angle": None, "radius": 1e4}
FILM = {"mechanisms": {"film_on_substrate": {"thickness": 3000.0, "substrate_modulus": 70.0}}}


@pytest.mark.parametrize("kinematics", ["small", "large"])
@pytest.mark.parametrize(
    "changes",
    [
        {"indenter": SPHERE},
        {"indenter": {"shape": "sphero_cone", "radius": 300.0}},
        {"indenter": {"modulus": 10.0, "poisson_ratio": 0.2}},
        {"indenter": {"friction": 0.3}},
        {"mechanisms": {"adhesion": {"work": 150.0}}},
        {"mechanisms": {"adhesion": {"work": 400.0}}, "indenter": SPHERE},
        {"mechanisms": {"adhesion": {"work": 150.0}}, "indenter": SPHERE | {"friction": 0.3}},
        {"mechanisms": {"size_effect": {"length": 20.0}}},
        FILM,
        {"material": PLASTIC},
        {"material": PLASTIC, "indenter": {"shape": "sphero_cone", "radius": 300.0}} | FILM,
    ],
    ids=[
        "sphere",
        "rounded",
        "elastic tip",
        "friction",
        "adhesion",
        "jump",
        "rubbing jump",
        "size",
        "film",
        "yield",
        "all",
    ],
)
def test_one_shape_of_mesh_runs_in_lanes_whatever_the_body(changes, kinematics):
    """Two meshes for one indentation, half a ring apart."""
    indenter = {k: v for k, v in (CONE | changes.get("indenter", {})).items() if v is not None}
    values = {
        "material": BURGERS | changes.get("material", {}),
        "indenter": indenter,
        "protocol": TEST,
        "kinematics": "small",
    }
    extra = {key: value for key, value in changes.items() if key == "mechanisms"}
    spec = specification_from(values | extra | {"kinematics": kinematics})
    solid, large = applied_to_body(spec), kinematics == "large"
    cases = [
        case(specimen=solid.specimen, indenter=solid.indenter, protocol=solid.protocol, large=large, shift=shift)
        for shift in (0.0, 0.5)
    ]
    assert_cases_as_alone(cases)


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("work", [0.0, 100.0])
@pytest.mark.parametrize("tip", [Indenter("cone", 70.3), Indenter("sphero_cone", 70.3, 200.0)], ids=["cone", "rounded"])
def test_contact_forces_have_a_potential(tip, work, large):
    """Without friction no work is left after a way round; without adhesion it is the difference of the potential.

    That is the sum of C p A w ((x^2 + 2 b - 1) Phi(x) + x phi(x)) / 2, see `palpate.solver.axisymmetric.contact`.
    """
    lanes = march_cases.padded([case(specimen=replace(case().specimen, adhesion=work), indenter=tip, large=large)])
    units = np.array([each.radii[0] for each in lanes])
    mesh = polar_mesh(lanes[0].shape, lanes[0].resolution.sectors)
    body = Body.of(mesh)
    march, states = march_cases.begun(lanes, lanes, mesh, body, units, System.of(body, True), 1e-9)
    contact, state, count = march.setup.contact, states.contact, len(body.distance)
    none, rng = np.zeros(LANES, dtype=bool), np.random.default_rng(4)
    fit(contact, state, np.full(LANES, 0.1), none)
    width = np.array([width_of(contact, state, k, 0) for k in range(count)])
    reference = np.array([profile_at(large, contact.tip, 0, r, 0.0)[0] for r in body.distance])

    def corner():
        u = np.zeros((body.size + 1, LANES))
        u[body.radial[1:]] = (width * rng.uniform(-1.0, 1.0, count))[1:, None]
        u[body.vertical] = (reference + width * rng.uniform(-2.0, 2.0, count))[:, None]
        return u, np.full(LANES, rng.uniform(-0.3, 0.3) * width[0])

    def work_between(start, end):
        total = 0.0
        for node, weight in zip(*np.polynomial.legendre.leggauss(80), strict=True):
            share = 0.5 * (1.0 + node)
            u, depth = ((1.0 - share) * a + share * b for a, b in zip(start, end, strict=True))
            forces, trial = np.zeros_like(u), states.trial._replace(displacement=u, depth=depth)
            contact_forces(march.setup, trial, forces, no_coupling(count))
            along = forces[:, 0] @ (end[0] - start[0])[:, 0] + trial.reaction[0] * (end[1] - start[1])[0]
            total += 0.5 * weight * along
        return total

    def potential(u, depth):
        trial = states.trial._replace(displacement=u, depth=depth)
        x = np.array([penetration(march.setup, trial, k, 0)[0] for k in range(count)])
        b, scale = state.blend[0], state.stiffness[0] * contact.area * width
        return (scale * 0.5 * ((x * x + 2.0 * b - 1.0) * norm.cdf(x) + x * norm.pdf(x))).sum()

    first, second, third = corner(), corner(), corner()
    there, across, back = work_between(first, second), work_between(second, third), work_between(third, first)
    size = max(abs(there), abs(across), abs(back))
    assert there + across + back == pytest.approx(0.0, abs=1e-9 * size)
    if not work:
        assert there == pytest.approx(potential(*second) - potential(*first), abs=1e-9 * size)


def losing_the_second(tries, taken=None):
    """Return `advance` of a march whose second lane finds no equilibrium in the first so many steps that it takes.

    Those that it takes then are counted: one more in `taken` for each.
    """
    left = [tries]

    def advance(*arguments):
        found = arguments[-1]
        newton.advance(*arguments)
        if found[1] and left[0] > 0:
            left[0] -= 1
            found[1] = False
        elif found[1] and taken is not None:
            taken.append(1)

    return advance


def test_a_lane_without_equilibrium_fails_alone(monkeypatch):
    cases = [case(), case(indenter=Indenter("cone", 68.0)), case()]
    whole = march_cases.indent_batch(cases)
    monkeypatch.setattr(march, "advance", losing_the_second(tries=1000))
    histories = march_cases.indent_batch(cases)
    assert [history.reason for history in histories] == ["", "no equilibrium beyond 0 s", ""]
    assert np.all(np.isnan(histories[1].depth))
    for place in (0, 2):
        np.testing.assert_allclose(histories[place].depth, whole[place].depth, rtol=1e-12)


def test_a_lane_that_finds_equilibrium_in_parts_of_a_step_goes_on_in_lanes(monkeypatch):
    """Its first step is then halved three times, and later ones begin from there; its neighbours differ by rounding."""
    cases = [case(), case(indenter=Indenter("cone", 68.0)), case()]
    steps, parts = [], []
    monkeypatch.setattr(march, "advance", losing_the_second(tries=0, taken=steps))
    whole = march_cases.indent_batch(cases)
    monkeypatch.setattr(march, "advance", losing_the_second(tries=3, taken=parts))
    histories = march_cases.indent_batch(cases)
    for place in (0, 2):
        np.testing.assert_allclose(histories[place].depth, whole[place].depth, rtol=1e-12)
    assert len(parts) == len(steps) + 7
    assert 0.0 < np.abs(histories[1].depth - whole[1].depth).max() < 1e-3 * whole[1].depth.max()
