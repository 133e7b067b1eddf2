"""A study of an elastic body under a cone, which is simulated in seconds, and recordings of it."""

from functools import cache

import numpy as np

from indentation_files.recording import Recording
from palpate import simulate

MATERIAL = {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.35}
CONE = {"shape": "cone", "half_angle": 70.3}
PROTOCOL = {"max_load": 2.0, "loading_time": 20, "hold_time": 10, "unloading_time": 20}
SETTINGS = {
    "study": "small",
    "points": 20,
    "material": {"model": "elastic", "poisson_ratio": 0.35},
    "parameters": {"youngs_modulus": [2.0, 2.7, 3.3, 4.0]},
    "indenter": CONE,
    "conditions": [{"name": "A", **PROTOCOL}],
    "calibration": {"population": 20, "generations": 5, "subpopulations": 2},
    "diagnosis": {"mechanisms": ["frame_compliance"], "bootstrap": 300},
}


@cache
def _exact():
    return simulate(material=MATERIAL, indenter=CONE, protocol=PROTOCOL | {"points": 60})


def measured(compliance=0.0, name="test", seed=1):
    """Return a recording of an elastic body, with noise of 0.3 nm and the frame's deflection."""
    curve = _exact()
    noise = 0.3 * np.random.default_rng(seed).standard_normal(len(curve.time))
    return Recording(curve.time, curve.load, curve.depth + noise + compliance * curve.load, name=name)
