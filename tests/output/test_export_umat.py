"""The Fortran user material, compiled: against the update of palpate, finite differences and rotations."""

import ctypes
import shutil
import subprocess
from importlib.resources import files

import numpy as np
import pytest

from palpate.materials import LAWS
from palpate.materials.flow.point import commit, history, length, solve, state_size
from palpate.materials.flow.row import step_weights
from palpate.output.export.abaqus import SUBROUTINE, user_constants
from palpate.solver.simulation import specification_from
from studies.verification.reference_materials import BURGERS as EPOXY

pytestmark = pytest.mark.skipif(not shutil.which("gfortran"), reason="gfortran is not installed")
ONE = EPOXY
TWO = ONE | {"transient_coefficient_2": 0.1, "transient_exponent_2": 0.3, "retardation_time_2": 20.0}
NONE = ONE | {"transient_coefficient": 0.0, "steady_exponent": 1.5, "steady_coefficient": 5.0}
LAW = LAWS["nonlinear_burgers"]
TURN = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture(scope="module")
def subroutine(tmp_path_factory):
    folder = tmp_path_factory.mktemp("umat")
    (folder / SUBROUTINE).write_bytes(files("palpate.output.export").joinpath(SUBROUTINE).read_bytes())
    command = ["gfortran", "-Wall", "-Wno-unused-dummy-argument", "-Wno-compare-reals", "-Werror", "-shared", "-fPIC"]
    subprocess.run([*command, "-O1", "-o", "umat.so", SUBROUTINE], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "umat.so")).umat_


def call(subroutine, constants, stress, state, change, dt, turn=None):
    """One call as Abaqus makes it; returns new stress, state and tangent."""
    n = len(stress)
    stress, state = stress.copy(), state.copy()
    tangent = np.zeros((n, n), order="F")
    number, vector, square = np.zeros(1), np.zeros(n), np.asfortranarray(np.eye(3) if turn is None else turn)
    cut = np.ones(1)

    def real(array):
        return array.ctypes.data_as(ctypes.c_void_p)

    def whole(value):
        return ctypes.byref(ctypes.c_int(value))

    step = (ctypes.c_int * 4)(1, 1, 0, 0)
    subroutine(
        real(stress), real(state), real(tangent), *(real(number),) * 4, real(vector), real(vector), real(number),
        real(np.zeros(n)), real(np.ascontiguousarray(change)), real(np.zeros(2)), real(np.array([dt])),
        *(real(number),) * 4, ctypes.c_char_p(b"BODY".ljust(80)), whole(3), whole(n - 3), whole(n), whole(len(state)),
        real(constants), whole(len(constants)), real(np.zeros(3)), real(square), real(cut), real(number),
        real(np.asfortranarray(np.eye(3))), real(np.asfortranarray(np.eye(3))), *(whole(1),) * 4, step, whole(1),
        ctypes.c_size_t(80),
    )  # fmt: skip
    assert cut[0] == 1.0
    return stress, state, tangent


def constants_of(values):
    """PROPS of the user material for the parameters of the law."""
    test = {"max_load": 1.0, "loading_time": 30.0, "unloading_time": 30.0}
    body = {"model": LAW.key} | values
    return user_constants(
        specification_from(
            {
                "material": body,
                "indenter": {"shape": "cone", "half_angle": 70.3},
                "protocol": test,
                "kinematics": "small",
            }
        )
    )


def path(seed=0, steps=12, scale=0.01):
    """Strain increments (rr, zz, tt, engineering rz) with their times: loading, reversal, long and short steps."""
    rng = np.random.default_rng(seed)
    changes = rng.normal(scale=scale, size=(steps, 4)) + 0.5 * scale * np.array([0.6, -1.0, 0.5, 0.4])
    changes[steps // 2] = 0.0
    return zip(changes, np.geomspace(1e-3, 50.0, steps), strict=True)


def reference(coefficients, strain, state, dt):
    """Palpate's own update from the total strain: stress and tangent in engineering shear; advances `state`."""
    weights, past = step_weights(coefficients[None], dt)[0], np.empty(4)
    deviator = strain.copy()
    deviator[3] *= 0.5
    volume = strain[:3].sum()
    deviator[:3] -= volume / 3
    history(state, weights, coefficients, past, np.empty(4))
    residual = deviator - past
    rho = length(residual, 4)
    q, slope, _ = solve(rho, 0.0, 0.0, 0.0, weights, coefficients)
    commit(state, residual, np.zeros(4), 0.0, q, 0.0, weights, coefficients)
    hydrostatic = np.array([1.0, 1.0, 1.0, 0.0])
    projection = np.diag([1.0, 1.0, 1.0, 0.5]) - np.outer(hydrostatic, hydrostatic) / 3
    tangent = q / rho * projection + (slope - q / rho) * np.outer(residual, residual) / (2 * rho**2)
    tangent += coefficients[1] * np.outer(hydrostatic, hydrostatic)
    return state[:4] + coefficients[1] * volume * hydrostatic, tangent


@pytest.mark.parametrize("values", [ONE, TWO, NONE], ids=["one", "two", "steady"])
def test_same_stress_and_tangent_as_palpate(subroutine, values):
    coefficients = LAW.coefficients(values)
    constants = constants_of(values)
    own, strain = np.zeros(state_size(coefficients, 4)), np.zeros(4)
    stress, state = np.zeros(4), np.zeros(4 * (1 + (len(constants) - 4) // 3))
    for change, dt in path():
        stress, state, tangent = call(subroutine, constants, stress, state, change, dt)
        strain += change
        expected, slope = reference(coefficients, strain, own, dt)
        assert stress == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())
        assert tangent == pytest.approx(slope, rel=1e-8, abs=1e-8 * np.abs(slope).max())
    assert state[4:8] == pytest.approx(own[10:14], rel=1e-7, abs=1e-12)
    assert state[:4] == pytest.approx(own[4:8], rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("components", [4, 6])
def test_tangent_is_the_derivative_of_the_stress(subroutine, components):
    constants = constants_of(TWO)
    rng = np.random.default_rng(2)
    stress, state = np.zeros(components), np.zeros(components * 3)
    for dt in (0.3, 5.0, 0.02):
        change = rng.normal(scale=0.01, size=components)
        before = stress, state
        stress, state, tangent = call(subroutine, constants, stress, state, change, dt)
        step = 1e-7
        numeric = [
            (call(subroutine, constants, *before, change + step * e, dt)[0]
             - call(subroutine, constants, *before, change - step * e, dt)[0]) / (2 * step)
            for e in np.eye(components)
        ]  # fmt: skip
        assert tangent == pytest.approx(np.stack(numeric, axis=1), abs=1e-6 * np.abs(tangent).max())


def tensor(voigt, shear):
    full = np.diag(voigt[:3])
    full[0, 1] = full[1, 0] = voigt[3] * shear
    return full


def voigt(full, shear):
    return np.array([full[0, 0], full[1, 1], full[2, 2], full[0, 1] / shear])


def test_a_rotation_between_steps_turns_the_answer(subroutine):
    """Abaqus hands over a stress already turned and a strain increment in the new frame; the state is turned here."""
    constants = constants_of(TWO)
    stress, state = np.zeros(4), np.zeros(12)
    steps = list(path(5, 6))
    for change, dt in steps[:-1]:
        stress, state, _ = call(subroutine, constants, stress, state, change, dt)
    change, dt = steps[-1]
    still, _, _ = call(subroutine, constants, stress, state, change, dt)
    turned_stress = voigt(TURN @ tensor(stress, 1.0) @ TURN.T, 1.0)
    turned_change = voigt(TURN @ tensor(change, 0.5) @ TURN.T, 0.5)
    turned, _, _ = call(subroutine, constants, turned_stress, state, turned_change, dt, TURN)
    assert turned == pytest.approx(voigt(TURN @ tensor(still, 1.0) @ TURN.T, 1.0), rel=1e-12, abs=1e-14)


def test_a_step_of_no_duration_is_elastic(subroutine):
    constants = constants_of(ONE)
    stress, _, tangent = call(subroutine, constants, np.zeros(4), np.zeros(8), np.array([0.0, 0.0, 0.0, 0.01]), 0.0)
    assert stress[3] == pytest.approx(constants[0] * 0.01, rel=1e-12)
    assert tangent[3, 3] == pytest.approx(constants[0], rel=1e-12)
