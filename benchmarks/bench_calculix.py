"""One elastic curve by palpate and by CalculiX on its cheapest mesh of equal accuracy, one core each, in the same run.

Accuracy is the root mean square deviation, from 15 % of the load on, from CalculiX on its fine mesh.
"""

import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.simulation import simulate
from studies.verification.calculix import run_deck
from studies.verification.cases.calculix_small import elastic

MESHES = [Resolution(growth=g, sectors=s, inner=0.1, far=500.0) for g, s in ((1.7, 3), (1.5, 4), (1.3, 5), (1.2, 6))]
os.environ["OMP_NUM_THREADS"] = "1"


@pytest.mark.skipif(not shutil.which("ccx"), reason="CalculiX (ccx) is not installed")
def test_elastic_curve(benchmark):
    program, specification = Path(shutil.which("ccx")), elastic(20)
    counts = specification.protocol.sample_load >= 0.15 * specification.protocol.max_load
    best = run_deck(program, specification, RESOLUTIONS["fine"])

    def error(found):
        return float(np.sqrt(np.mean((found / best - 1)[counts] ** 2)))

    simulate(specification)
    simulation = benchmark.pedantic(simulate, args=(specification,), rounds=5)
    own = error(simulation.depth)
    for mesh in MESHES:
        began = time.perf_counter()
        found = error(run_deck(program, specification, mesh))
        seconds = time.perf_counter() - began
        if found <= own:
            break
    benchmark.extra_info.update(
        palpate_error_percent=100 * own, calculix_error_percent=100 * found, calculix_growth=mesh.growth,
        calculix_seconds=seconds, times_faster=seconds / benchmark.stats.stats.median,
    )  # fmt: skip
