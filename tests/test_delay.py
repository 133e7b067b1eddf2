"""A delay past which a sample lies at no load: the curve has a kink there, and a search must not stay in it."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from palpate.calibration import Observation
from palpate.calibration.space import Space
from palpate.config import Condition
from palpate.diagnosis.covariance import errors, noise_of
from palpate.diagnosis.fit import solve
from palpate.diagnosis.problem import Problem
from palpate.mechanisms import Scale
from palpate.protocol import trapezoid

LAG = ("controller_lag",)
CONDITION = Condition("a", "calibrate", trapezoid(4.0, 20.0, 10.0, 20.0, points=60))
TIME, LOAD = CONDITION.protocol.sample_time, CONDITION.protocol.sample_load
SCALE = Scale(depth=1000, load=4.0, modulus=3.0, duration=50, loading_time=20, half_angle=70.3, pressure=0.2)
SPACE = Space({"modulus": (0.7, 1.4)})
LARGEST = 2.0  # s, of the delays that are searched in tests of this length


@dataclass(frozen=True, eq=False)
class Cone:
    """h = c sqrt(P) / modulus."""

    loo_error_ = np.zeros((1, len(TIME)))

    def evaluate(self, x):
        return 500.0 * np.sqrt(LOAD)[None] / np.atleast_2d(x)[:, :1]

    def jacobian(self, x):
        return -self.evaluate(x).T / x[0]


class Nothing:
    """What is left to learn of a delay of a body that does not age."""

    error = unresolved = np.zeros((1, len(TIME)))

    def predict(self, x):
        return np.zeros((len(x), len(TIME)))


def task(depth):
    """Return a problem with recordings (n, n_points)."""
    observed = {"a": Observation(TIME, depth)}
    effects, fine = {"a": {"controller_lag": Nothing()}}, {"a": np.ones(len(TIME))}
    return Problem((CONDITION,), observed, SPACE, {"a": Cone()}, effects, fine, SCALE)


def solved(lag, start, radius=0.3):
    """Return the truth's coordinates and the fit that a search from some coordinates ends at."""
    truth = np.array([0.4, lag / LARGEST])
    curve = task(np.zeros((1, len(TIME)))).curves(LAG, truth[None])
    problem = task(curve + 0.3 * np.random.default_rng(3).standard_normal((4, len(TIME))))
    none = np.zeros(len(TIME))
    found = errors(problem, LAG, none, noise_of(problem, (), none, 0.01), 0.001)
    return truth, solve(problem, LAG, found, [np.asarray(start)], radius=radius)


@pytest.mark.parametrize("beyond", [0.01, 0.1])
@pytest.mark.parametrize("sample", [0, 1])
def test_a_search_leaves_the_kink_of_a_sample(sample, beyond):
    at = TIME[sample]
    truth, fit = solved(at + beyond, [0.4, (at - 1e-4) / LARGEST])
    assert abs(fit.z[1] - truth[1]) < 4.0 * np.sqrt(fit.posterior[1, 1])
    assert fit.misfit <= replace(fit, z=truth).misfit + 0.1


def test_the_slope_in_a_kink_is_that_of_the_flatter_side():
    problem, here = task(np.zeros((1, len(TIME)))), np.array([0.4, TIME[0] / LARGEST])
    slope = problem.jacobian(LAG, here)[:, 1]
    ahead = problem.jacobian(LAG, here + np.array([0.0, 1e-3]))[:, 1]
    assert slope[0] == 0.0
    assert slope[2:20] == pytest.approx(ahead[2:20], rel=0.02)


def test_a_search_within_a_small_radius_stays_there():
    truth, fit = solved(1.0, [0.4, 0.505], radius=0.005)
    assert fit.z == pytest.approx(truth, abs=0.006)
