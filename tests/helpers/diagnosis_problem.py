"""A study in closed form as a problem of the diagnosis: its recordings with known noise, its fits and its search."""

from types import SimpleNamespace

import numpy as np
from closed_forms import TRUTH, ClosedForms, cone
from scipy.linalg import toeplitz

from palpate.configuration.condition import Condition
from palpate.configuration.settings import CalibrationSettings, DiagnosisSettings
from palpate.data.observation import Observation
from palpate.diagnosis.search import Search
from palpate.inference.problem import Problem
from palpate.mechanisms import Scale
from palpate.study.protocol import trapezoid

RECORD_ONLY = ["frame_compliance", "thermal_drift", "zero_offset"]
CONDITIONS = tuple(
    Condition(name, "calibrate", trapezoid(load, rise, hold, rise, points=60), order=3.0 * number - 4.5)
    for number, (name, load, rise, hold) in enumerate(
        [("a", 1.0, 10, 0), ("b", 1.0, 40, 20), ("c", 4.0, 20, 20), ("d", 0.2, 20, 0)]
    )
)
SCALE = Scale(depth=1000, load=4.0, modulus=3.0, duration=100, loading_time=10, half_angle=70.3, pressure=0.2)
STUDY = SimpleNamespace(
    seed=1,
    diagnosis=DiagnosisSettings(bootstrap=400),
    calibration=CalibrationSettings(site_scatter=0.01, solver_error=0.003, law_error=0.0),
)


def recordings(rng, effect=lambda c, r: 0.0, replicates=3, sigma=1.0, memory=0.8, site=0.01, conditions=CONDITIONS):
    observed = {}
    for condition in conditions:
        time = condition.protocol.sample_time
        point = sigma**2 * toeplitz(memory ** np.arange(len(time)))
        depth = cone(condition.protocol, **TRUTH)
        rows = [
            depth * (1 + site * rng.standard_normal())
            + effect(condition, r)
            + rng.multivariate_normal(np.zeros(len(time)), point, method="cholesky")
            for r in range(replicates)
        ]
        observed[condition.name] = Observation(time, np.array(rows), "calibrate")
    return observed


def problem(observed, conditions=CONDITIONS, **bodily):
    return Problem(conditions, observed, ClosedForms(conditions, bodily=bodily), SCALE)


class Known(Search):
    """A search whose base model nobody has fitted yet."""

    def __init__(self, task, heard=None):
        super().__init__(STUDY, task, [], np.random.default_rng(0), TRUTH)
        if heard is not None:
            self._fitter.use_residual_as_noise(heard)


def fitted(task, explanation=(), start=None, residual=None):
    """Return the fit of an explanation; without replicates with the noise that was `residual`, if that is given."""
    coordinates = task.coordinates(explanation)
    start = np.full(len(coordinates.free), 0.5) if start is None else start
    return Known(task, residual).fitted(explanation, [start], task.mean)


def search_of(task, keys=RECORD_ONLY):
    return Search(STUDY, task, keys, np.random.default_rng(0), TRUTH)
