"""How much the depth of one simulation depends on where the nodes lie.

Ripple is the scatter (root mean square) of the depth at fixed load over eight offsets of the mesh, all nodes shifted
outwards by eighths of their spacing, relative to the depth, from 5 % of the largest load on.

    python tests/helpers/ripple.py

prints it for all bodies, tips and strains of docs/contact.md.
"""

from dataclasses import replace
from itertools import product

import numpy as np
from bodies import case_of

from palpate.solver.axisymmetric.march_cases import run_lanes
from palpate.solver.simulation import specification_from
from studies.verification.reference_materials import BURGERS

OFFSETS = 8
FROM = 0.05  # of the largest load
BODIES = {
    "elastic": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
    "burgers": {"model": "nonlinear_burgers"} | BURGERS,
    "polymer": {
        "model": "bilinear_plasticity",
        "youngs_modulus": 3.3,
        "poisson_ratio": 0.35,
        "yield_stress": 0.1,
        "hardening": 0.3,
    },
    "aluminium": {
        "model": "bilinear_plasticity",
        "youngs_modulus": 70.0,
        "poisson_ratio": 0.345,
        "yield_stress": 0.1,
        "hardening": 0.5,
    },
}
TIPS = {
    "cone": {"shape": "cone", "half_angle": 70.3},
    "rounded": {"shape": "sphero_cone", "half_angle": 70.3, "radius": 500.0},
    "sphere": {"shape": "sphere", "radius": 5000.0},
    "measured": {"shape": "area_function", "area": [24.56, 2000.0, -300.0, 500.0]},
}


def indentation(body: str, tip: str, kinematics: str, friction: float = 0.0, mechanisms: dict | None = None):
    """Return the specification of 30 s to 1 mN and 30 s back."""
    return specification_from(
        {
            "material": BODIES[body],
            "indenter": TIPS[tip] | {"friction": friction},
            "protocol": {"max_load": 1.0, "loading_time": 30, "unloading_time": 30, "points": 100},
            "kinematics": kinematics,
            "mechanisms": mechanisms or {},
        }
    )


def ripple(specification) -> float:
    """Return the scatter of the depth over offsets of the mesh."""
    case = case_of(specification)
    histories = run_lanes([replace(case, shift=k / OFFSETS) for k in range(OFFSETS)])
    assert not any(history.reason for history in histories), [history.reason for history in histories]
    depth, load = np.array([history.depth for history in histories]), specification.protocol.sample_load
    scatter = depth.std(axis=0) / depth.mean(axis=0)
    return float(np.sqrt(np.mean(scatter[load >= FROM * load.max()] ** 2)))


if __name__ == "__main__":
    for row in product(BODIES, TIPS, ("small", "large"), (0.0, 0.25)):
        try:
            print(*row, f"{ripple(indentation(*row)):.1e}", flush=True)
        except AssertionError as lost:
            print(*row, lost, flush=True)
