"""A delay past which a sample lies at no load: the curve has a kink there, and a search must not stay in it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from closed_forms import MATERIAL, TRUTH, ClosedForms

from palpate.configuration.condition import Condition
from palpate.configuration.settings import CalibrationSettings, DiagnosisSettings
from palpate.data.observation import Observation
from palpate.diagnosis.search import Search
from palpate.inference.problem import Problem
from palpate.mechanisms import Scale
from palpate.models.coordinates import Coordinates
from palpate.study.protocol import trapezoid

LAG = ("controller_lag",)
CONDITION = Condition("a", "calibrate", trapezoid(4.0, 20.0, 10.0, 20.0, points=60))
TIME = CONDITION.protocol.sample_time
SCALE = Scale(depth=1000, load=4.0, modulus=3.0, duration=50, loading_time=20, half_angle=70.3, pressure=0.2)
ELASTIC = Coordinates(MATERIAL.free[:1], {"fluidity": 0.0})
LARGEST = 2.0  # s, of the delays that are searched in tests of this length
STUDY = SimpleNamespace(
    calibration=CalibrationSettings(solver_error=0.001, site_scatter=0.01, law_error=0.0),
    seed=1,
    diagnosis=DiagnosisSettings(bootstrap=400, largest_set=1),
)


class Cone(ClosedForms):
    """h = c sqrt(P) / modulus, with the load of some time ago."""

    def _curve(self, u, condition):
        lag = self.amplitudes(u).get("controller_lag", {"lag": 0.0})["lag"]
        load = condition.protocol.drive_at(np.maximum(condition.protocol.sample_time - lag, 0.0))
        depth = 500.0 * np.sqrt(load) / self.coordinates.named(u)["modulus"]
        return depth[self.keep[condition.name]] if self.keep else depth


def task(depth):
    """Return a problem with recordings (n, n_points)."""
    return Problem((CONDITION,), {"a": Observation(TIME, depth)}, Cone((CONDITION,), ELASTIC), SCALE)


def solved(lag, start):
    """Return a fit at the truth, and the one that a search from some coordinates ends at."""
    truth = np.array([0.4, lag / LARGEST])
    (curve,) = task(np.zeros((1, len(TIME)))).model(LAG).curves([truth])
    problem = task(curve["a"] + 0.3 * np.random.default_rng(3).standard_normal((4, len(TIME))))
    search = Search(STUDY, problem, [], np.random.default_rng(0), TRUTH)
    fit = search.fitted(LAG, [np.asarray(start)], problem.mean)
    return replace(fit, z=truth, curve=curve["a"]), fit


@pytest.mark.parametrize("beyond", [0.01, 0.1])
@pytest.mark.parametrize("sample", [0, 1])
def test_a_search_leaves_the_kink_of_a_sample(sample, beyond):
    at = TIME[sample]
    truth, fit = solved(at + beyond, [0.4, (at - 1e-4) / LARGEST])
    assert abs(fit.z[1] - truth.z[1]) < 4.0 * np.sqrt(fit.posterior[1, 1])
    assert fit.misfit <= truth.misfit + 0.1
