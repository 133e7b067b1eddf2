"""Cost of the derivatives by six parameters beside one simulation, on one core (set OMP_NUM_THREADS=1)."""

from dataclasses import replace
from time import process_time

import numpy as np
import pytest

from palpate.solver.simulation import differentiated, simulate, specification_from
from palpate.solver.variation import Variation
from studies.verification.reference_materials import BURGERS as EPOXY

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
    steps = {name: 3e-5 * spec.parameters[name] for name in SIX}
    moved = [replace(spec, parameters=spec.parameters | {name: spec.parameters[name] + steps[name]}) for name in SIX]
    both = [spec], [list(map(Variation, moved, steps.values()))]
    simulate(spec)
    differentiated(*both)
    pairs = [(seconds(simulate, spec), seconds(differentiated, *both)) for _ in range(5)]
    alone, together = np.median(pairs, axis=0)
    benchmark.pedantic(differentiated, args=both, rounds=5)
    benchmark.extra_info.update(simulation_cpu_seconds=alone, share_of_one_simulation=(together - alone) / alone)
    assert together - alone < alone
