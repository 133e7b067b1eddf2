r"""Contact stiffness freed from creep and drift at the start of unloading.

    1/S_e = 1/S + (dh/dt at the end of the hold) / |dP/dt at the start of unloading|

(Feng and Ngan 2002, J. Mater. Res. 17, 660, eq. 4; Ngan et al. 2005, J. Mater. Res. 20, 2788). Thermal drift adds to
dh/dt and is corrected along with creep. The result is the elastic stiffness only if the material creeps at the
same rate just before and just after the load turns.
"""

from __future__ import annotations

import numpy as np

from palpate.errors import InputError

LAST = 0.3  # of the hold, to which the parabola is fitted that gives the rate at its end


def corrected_stiffness(stiffness: float, creep_rate: float, unloading_rate: float) -> float:
    """Return the elastic stiffness S_e [mN/nm]; raises `InputError` where nothing is unloaded.

    Parameters
    ----------
    stiffness
        Apparent S = dP/dh at the start of unloading [mN/nm]; negative where the curve has a nose.
    creep_rate
        dh/dt at the end of the hold [nm/s].
    unloading_rate
        |dP/dt| at the start of unloading [mN/s].
    """
    if unloading_rate <= 0:
        raise InputError(f"the unloading rate is {unloading_rate:g} mN/s", remedy="give its magnitude, above zero")
    return 1.0 / (1.0 / stiffness + creep_rate / unloading_rate)


def creep_rate(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> float:
    """Return dh/dt [nm/s] at the end of the hold: the end slope of a parabola through the last 30 % of the hold.

    The hold ends with the last point within 0.1 % of the largest load; what follows already unloads, and recovers.

    Parameters
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm].

    Raises
    ------
    InputError
        When the recording has no hold of at least eight points.
    """
    hold = np.flatnonzero(load > 0.995 * load.max())
    hold = hold[hold <= np.flatnonzero(load > 0.999 * load.max())[-1]]
    last = hold[-max(4, int(LAST * len(hold))) :]
    if len(hold) < 8:
        raise InputError("the recording has no hold", remedy="use a test that holds the largest load before unloading")
    fit = np.polynomial.Polynomial.fit(time[last], depth[last], 2)
    return float(fit.deriv()(time[last[-1]]))
