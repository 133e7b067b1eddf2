"""Cost of the derivatives by six parameters beside one simulation, on one core (set OMP_NUM_THREADS=1)."""

from time import process_time

import numpy as np
import pytest

from palpate.model import sensitivities, simulate, specification_from

BURGERS = {
    "model": "nonlinear_burgers",
    "youngs_modulus": 3.28,
    "poisson_ratio": 0.34,
    "steady_coefficient": 0.09,
    "steady_exponent": 0.20,
    "transient_coefficient": 0.24,
    "transient_exponent": 0.47,
    "retardation_time": 0.25,
}
SIX = list(BURGERS)[1:7]


def seconds(function, *arguments):
    began = process_time()
    function(*arguments)
    return process_time() - began


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_six_parameters(benchmark, kinematics):
    spec = specification_from(
        {
            "material": BURGERS,
            "indenter": {"shape": "cone", "half_angle": 70.3},
            "protocol": {"max_load": 1.0, "loading_time": 30, "unloading_time": 30, "points": 100},
            "kinematics": kinematics,
        }
    )
    simulate(spec)
    sensitivities(spec, SIX)
    pairs = [(seconds(simulate, spec), seconds(sensitivities, spec, SIX)) for _ in range(5)]
    alone, together = np.median(pairs, axis=0)
    benchmark.pedantic(sensitivities, args=(spec, SIX), rounds=5)
    benchmark.extra_info.update(simulation_cpu_seconds=alone, share_of_one_simulation=(together - alone) / alone)
    assert together - alone < alone
