"""Sobol indices from a surrogate: shares of the variance with all interactions, unlike those of orthogonal arrays.

First-order and total indices by Saltelli's estimators as SciPy implements them (Saltelli et al. 2010, Comput. Phys.
Commun. 181, 259), over parameters that are uniform on their ranges.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import sobol_indices, uniform

from palpate.data.measures import relative
from palpate.surrogate import PODRBF
from studies.thesis.study import Rows

SAMPLES = 2048


def total_indices(surrogate: PODRBF, levels: Mapping[str, Sequence[float]], recorded: np.ndarray, seed: int) -> Rows:
    """Return first-order and total indices of the largest depth and of chapter 4's error, one row a parameter."""
    free = [name for name, values in levels.items() if len(values) > 1]
    held = {name: values[0] for name, values in levels.items()}

    def curves(points: np.ndarray) -> np.ndarray:
        by_name = dict(zip(free, points, strict=True))
        columns = [by_name.get(name, np.full(points.shape[1], held[name])) for name in levels]
        return surrogate.predict(np.column_stack(columns))

    def both(points: np.ndarray) -> np.ndarray:
        depth = curves(points.reshape(len(free), -1))
        values = np.stack([depth.max(axis=1), relative(recorded, depth)])
        return values.reshape(2, *points.shape[1:])

    ranges = [uniform(min(levels[name]), max(levels[name]) - min(levels[name])) for name in free]
    found = sobol_indices(func=both, n=SAMPLES, dists=ranges, rng=np.random.default_rng(seed))
    return [
        {
            "parameter": name,
            "depth_first_percent": 100 * float(found.first_order[0, k]),
            "depth_total_percent": 100 * float(found.total_order[0, k]),
            "error_first_percent": 100 * float(found.first_order[1, k]),
            "error_total_percent": 100 * float(found.total_order[1, k]),
        }
        for k, name in enumerate(free)
    ]
