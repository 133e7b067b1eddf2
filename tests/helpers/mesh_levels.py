"""How far the depth at `accuracy: standard` lies from the value to which refined meshes extrapolate.

The rings of two finer meshes grow by 1.05 and 1.033, with 16 and 24 sectors; all take the same steps. The limit at each
sample is that of depth = limit + slope h^2, with h the logarithm of the growth.

    python tests/helpers/mesh_levels.py

prints the root mean square and the largest deviation from 5 % of the load on, for the bodies of docs/contact.md.
"""

from dataclasses import replace
from itertools import product

import numpy as np
from bodies import case_of
from ripple import BODIES, FROM, indentation

from palpate.solver.axisymmetric.march_cases import run_lanes

REFINED = {1.05: 16, 1.0 + 0.1 / 3.0: 24}  # growth of the rings: sectors


def deviation(specification) -> np.ndarray:
    """Return by how much the depth at `standard` departs from the limit (n,) [-] from a part of the load on."""
    case = case_of(specification)
    meshes = [replace(case.resolution, growth=growth, sectors=sectors) for growth, sectors in REFINED.items()]
    coarse, fine, finest = (_depth(replace(case, resolution=each)) for each in (case.resolution, *meshes))
    first, second = np.log(list(REFINED)) ** 2
    limit = finest + (finest - fine) * second / (first - second)
    load = specification.protocol.sample_load
    return (coarse / limit - 1.0)[load >= FROM * load.max()]


def _depth(case) -> np.ndarray:
    (history,) = run_lanes([case])
    assert not history.reason, history.reason
    return history.depth


if __name__ == "__main__":
    for body, tip, kinematics in product(BODIES, ("cone", "rounded", "sphere"), ("small", "large")):
        try:
            found = deviation(indentation(body, tip, kinematics))
        except AssertionError as lost:
            print(body, tip, kinematics, lost, flush=True)
            continue
        rms, largest = np.sqrt(np.mean(found**2)), np.abs(found).max()
        print(body, tip, kinematics, f"{100 * rms:.2f}, {100 * largest:.2f} %", flush=True)
