"""Cost of the derivatives by six parameters beside one simulation, on one core (set OMP_NUM_THREADS=1)."""

from time import process_time

import numpy as np
import pytest

from palpate.solver.simulation import sensitivities, simulate, specification_from
from palpate.verification.reference_materials import BURGERS as EPOXY

BURGERS = {"model": "nonlinear_burgers", **EPOXY}
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
