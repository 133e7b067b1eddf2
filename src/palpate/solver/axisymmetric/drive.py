"""What is prescribed in each lane: the last equation of the system, which determines the depth h.

    force_weight * F + depth_weight * h = target

Under load control that is F = P or, beside a spring of stiffness S, F - S h = P; without load the spring is left out,
whose contact the mesh does not resolve. Under displacement control C F + h = z, times the stiffness K of transducer and
contact in series, so that it counts as a force whatever the transducer: K C is one for a soft spring, and zero for a
rigid one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.mesh import LEAST_LOAD
from palpate.study.protocol import LOAD, Protocol

NO_LOAD = 1e-5  # of the largest load: what counts as none


@dataclass(frozen=True, eq=False)
class Drives:
    """The drives of all lanes, lengths in units of the lanes.

    Parameters
    ----------
    protocols
        What is prescribed when [mN] or [nm].
    factor : ndarray, shape (LANES,)
        Target of a unit of the drive.
    force_weight, depth_weight : ndarray, shape (LANES,)
    scale : ndarray, shape (LANES,)
        Largest load, as expected under displacement control.
    displaced : ndarray of bool, shape (LANES,)
        Whether a displacement is prescribed.
    least : ndarray, shape (LANES,)
        Least target: a contact under no load has no depth of its own.
    """

    protocols: Sequence[Protocol]
    factor: np.ndarray
    force_weight: np.ndarray
    depth_weight: np.ndarray
    scale: np.ndarray
    displaced: np.ndarray
    least: np.ndarray

    @classmethod
    def of(
        cls, protocols: Sequence[Protocol], expected: Sequence[float], adhesive: np.ndarray, units: np.ndarray
    ) -> Drives:
        """Return the drives of histories whose largest loads are `expected` to be so much [mN]; `units` in um.

        Where the contact is `adhesive` (LANES,) it bears no load at a depth of its own.

        Parameters
        ----------
        protocols
            History of each lane.
        expected
            Largest load of each [mN].
        adhesive : ndarray of bool, shape (LANES,)
            Whether tip and body attract each other.
        units : ndarray, shape (LANES,)
            Unit of length of each lane [um].
        """
        loads = np.array(expected)
        free = np.array([protocol.control == LOAD for protocol in protocols])
        compliance = np.array([protocol.compliance for protocol in protocols])
        spring = np.array([protocol.spring for protocol in protocols])
        drive = np.array([protocol.largest_drive for protocol in protocols])
        series = np.where(free, 1.0, loads / drive)
        return cls(
            protocols,
            series / units**2,
            np.where(free, 1.0, series * compliance),
            np.where(free, -spring, series) * 1e3 / units,
            loads / units**2,
            ~free,
            np.where(free & ~adhesive, NO_LOAD * loads / units**2, -np.inf),
        )

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return the drive (LANES,) at times (LANES,) [s]; [mN] or [nm]."""
        return np.array([float(p.drive_at(time)) for p, time in zip(self.protocols, times, strict=True)])

    def equation(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return force weights, depth weights and targets (LANES,) at times (LANES,) [s]."""
        target = self.factor * self.at(times)
        sprung = self.displaced | (target > LEAST_LOAD * self.scale)
        return self.force_weight, np.where(sprung, self.depth_weight, 0.0), np.maximum(target, self.least)

    def loading(self, times: np.ndarray) -> np.ndarray:
        """Return numbers (LANES,) that grow as the loads of sharp tips do until the times (LANES,) [s]."""
        drive = np.maximum(self.at(times), 0.0)
        return np.where(self.displaced, drive**2, drive)
