r"""Ting's extension to unloading: linear viscoelastic indentation after the contact has begun to shrink.

Let A(t) = int M dP as long as it grows, up to t_m. Later the contact radius is that of an earlier time t_1(t) < t_m,
and with the relaxation function psi, int psi(t - t') dM(t') = 1,

    P(t) = int_0^{t_1} psi(t - t') dA(t')       gives t_1 from the load,
    0    = int_{t_1}^{t} psi(t - t') dh(t')     gives the depth

as long as the load does not rise again, because the contact then grows anew (Ting 1966, J. Appl. Mech. 33, 845; 1968,
J. Appl. Mech. 35, 248). Both integrals are taken on an even grid, psi at the middle of its intervals, found from M on
the same grid.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_toeplitz

from palpate.classical.viscoelastic_depth import Compliance, depth_of, hereditary
from palpate.errors import InputError
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol

STEPS = 400  # equal intervals of a test; chosen


def relaxation(compliance: Compliance, step: float, count: int) -> np.ndarray:
    """Return psi (count,) [GPa] at the middles (k + 1/2) step, constant over each interval.

    It solves the discrete int psi(t - t') dM(t') = 1 exactly on the grid: with M at the ends of the intervals,
    sum_j psi_{k-j} (M_{j+1} - M_j) + psi_k M_0 = 1 in the mean of neighbouring rows.
    """
    mean = np.diff(compliance.integral(step * np.arange(count + 1))) / step
    first = np.concatenate([[mean[0]], np.diff(mean)])
    row = np.zeros(count)
    row[0] = first[0]
    return solve_toeplitz((first, row), np.ones(count))


def depth(compliance: Compliance, indenter: Indenter, protocol: Protocol, steps: int = STEPS) -> np.ndarray:
    """Return the depth (n,) [nm] at the sampling times, unloading included.

    Parameters
    ----------
    compliance
        Creep compliance of the half-space.
    indenter, protocol
        Tip and load history.
    steps
        Number of equal time steps of the integration.

    Raises
    ------
    InputError
        When the load rises again after it has fallen.
    """
    change = np.diff(protocol.knot_load)
    again = np.maximum.accumulate(change < 0.0) & (change > 0.0)
    if again.any():
        raise InputError(
            f"the load rises again at {protocol.knot_time[np.argmax(again)]:g} s, where the closed form does not hold",
            remedy="use one loading and one unloading, with holds between",
            place="loads",
        )
    time = np.linspace(0.0, protocol.sample_time[-1], steps + 1)
    step = time[1]
    square = hereditary(compliance, protocol, time)
    peak = int(np.argmax(square))
    found = depth_of(indenter, square)
    psi = relaxation(compliance, step, steps)
    load = protocol.load_at(time)
    growth, sinking = np.diff(square[: peak + 1]), np.zeros(steps)
    sinking[:peak] = np.diff(found[: peak + 1])
    for k in range(peak + 1, steps + 1):
        borne = np.concatenate([[0.0], np.cumsum(psi[k - 1 - np.arange(peak)] * growth)])
        earlier = float(np.interp(load[k], borne, np.arange(peak + 1)))
        sinking[k - 1] = -_since(psi, sinking, earlier, k) / psi[0]
        found[k] = found[k - 1] + sinking[k - 1]
    return np.interp(protocol.sample_time, time, found)


def _since(psi: np.ndarray, sinking: np.ndarray, earlier: float, k: int) -> float:
    """Return the part of int_{t_1}^{t_k} psi dh that is known, that is without the last interval."""
    first = int(earlier)
    known = np.arange(first, k - 1)
    total = float(np.sum(psi[k - 1 - known] * sinking[known]))
    if first < k - 1:
        total -= (earlier - first) * psi[k - 1 - first] * sinking[first]
    return total
