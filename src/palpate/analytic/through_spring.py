r"""A tip on a linear viscoelastic, incompressible half-space, pressed through a spring of compliance C.

    P = c int_0^t Y(t - t') d(h^n),    z(t) = h + C P,

of `palpate.analytic.relaxing_cone` and `palpate.analytic.relaxing_sphere`. With Y = Y_inf + sum_i Y_i exp(-lambda_i t)
the integral is q Y(0) - sum_i Y_i y_i, q = h^n, with

    dy_i/dt = lambda_i (q - y_i),

so that two equations determine h and P at any y. Holds while contact does not shrink.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444, and the equilibrium of the spring.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from palpate.analytic.relaxation_modulus import RelaxationModulus
from palpate.errors import InputError
from palpate.study.protocol import Protocol

TOLERANCE = 1e-10


def load_and_depth(
    modulus: RelaxationModulus, protocol: Protocol, factor: float, exponent: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return load [mN] and depth [nm] at the protocol's sampling times, shape (n,) each.

    Parameters
    ----------
    modulus
        Relaxation modulus of the half-space.
    factor, exponent
        c and n of the tip.

    Raises
    ------
    InputError
        When the depth falls before the last sample.
    """
    instantaneous = modulus.equilibrium + float(modulus.moduli.sum())
    compliance = 1e-3 * protocol.compliance

    def force(h: float, y: np.ndarray) -> float:
        return factor * (instantaneous * h**exponent - float(modulus.moduli @ y))

    def depth(t: float, y: np.ndarray) -> float:
        z = 1e-3 * float(protocol.drive_at(np.array(t)))
        if compliance == 0.0 or z <= 0.0:
            return z
        most = 2.0 * z + 1.0
        return float(brentq(lambda h: h + compliance * force(h, y) - z, 0.0, most, xtol=1e-15, rtol=1e-14))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return modulus.rates * (depth(t, y) ** exponent - y)

    y, found, start = np.zeros(len(modulus.rates)), [], 0.0
    for corner in protocol.knot_time[1:]:
        wanted = protocol.sample_time[(protocol.sample_time > start) & (protocol.sample_time <= corner)]
        ends = np.union1d(wanted, corner)
        path = solve_ivp(rate, (start, corner), y, t_eval=ends, rtol=TOLERANCE, atol=1e-14, method="DOP853")
        for t, state in zip(path.t, path.y.T, strict=True):
            if t in wanted:
                h = depth(t, state)
                found.append((force(h, state), 1e3 * h))
        y, start = path.y[:, -1], corner
    load, depths = np.array(found).T
    if np.any(np.diff(depths) < -1e-9 * depths.max()):
        raise InputError(
            "contact shrinks before the last sample", remedy="end the samples where unloading begins", place="protocol"
        )
    return load, depths
