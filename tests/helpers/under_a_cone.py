"""A law alone and joined with Burgers creep under a cone: what any law without a length must satisfy there."""

import numpy as np

from palpate.solver.simulation import simulate_batch, specification_from
from studies.verification.reference_materials import BURGERS

HOOKE = {"youngs_modulus": 3.28, "poisson_ratio": 0.34}
CREEP = {name: value for name, value in BURGERS.items() if name not in HOOKE}
LAWS = ("", "+nonlinear_burgers")


def specification(model, flow, load=1.0, time=1.0, kinematics="large"):
    material = {"model": model} | HOOKE | flow | (CREEP if "burgers" in model else {})
    protocol = {"max_load": load, "loading_time": 30.0 * time, "unloading_time": 30.0 * time, "points": 12}
    return specification_from(
        {
            "material": material,
            "indenter": {"shape": "cone", "half_angle": 70.3},
            "protocol": protocol,
            "kinematics": kinematics,
        }
    )


def depths(*specifications):
    """Return the curves (k, n) [nm] of specifications that run in lanes together, all of which must converge."""
    simulations = simulate_batch(specifications)
    assert [simulation.status for simulation in simulations] == ["ok"] * len(simulations)
    return np.array([simulation.depth for simulation in simulations])


def check_law(key, flow, weaker, same):
    """A law, alone and joined: deeper where it is `weaker`, and as deep with other units of time or stress, `same`.

    Parameters
    ----------
    same
        The flow in a unit of time ten times as long.
    """
    for added in LAWS:
        model = key + added
        plain, soft = depths(specification(model, flow), specification(model, flow | weaker))
        assert np.all(soft[1:-1] > plain[1:-1]) and np.all(plain[1:-1] > 0.0)
        if not added:
            longer = depths(specification(model, same, time=10.0), specification(model, same | weaker, time=10.0))[0]
            assert np.abs(longer - plain).max() < 2e-4 * plain.max()
            elastic = depths(specification("elastic", {}), specification("elastic", {"youngs_modulus": 3.0}))[0]
            assert plain.max() > 1.02 * elastic.max()
