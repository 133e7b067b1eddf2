"""What a simulated indentation leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class History:
    """Outcome of one simulated indentation.

    Attributes
    ----------
    depth : ndarray, shape (n,)
        Depth at the protocol's sampling times [nm]; NaN from a failure on.
    load : ndarray, shape (n,)
        Load there [mN]; likewise.
    reason
        Why the history is incomplete; empty when it is whole.
    seconds
        Wall time spent in the solver.
    perturbed_depths, perturbed_loads : ndarray, shape (p, n)
        Likewise of neighbours, see `palpate.solver.axisymmetric.neighbours`.
    """

    depth: np.ndarray
    load: np.ndarray
    reason: str
    seconds: float
    perturbed_depths: np.ndarray
    perturbed_loads: np.ndarray
