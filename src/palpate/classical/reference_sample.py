r"""The frame's compliance from unloadings of a solid of known modulus under a tip of known area, all from one load.

    C_f = dh/dP - sqrt(pi) / (2 beta E_r sqrt(A(h_c)))      h_c = h_max - C_f P - eps P (dh/dP - C_f)

What is known of modulus and tip limits it: the contact yields much more than the frame, so 1 % of E_r sqrt(A) is 1 % of
the contact's compliance, often a good part of the frame's. Unloadings from several loads need neither
(`palpate.classical.frame`). The depth must begin at contact.

Source: W.C. Oliver and G.M. Pharr, J. Mater. Res. 7 (1992) 1564-1583, equations (3), (8) and (9).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from palpate.classical.frame import FrameCompliance
from palpate.classical.oliver_pharr import BETA, EPSILON, fit_unloading, last_at_peak
from palpate.study.area_function import AreaFunction

ROUNDS = 12  # in which the frame's deflection is taken off and found anew; chosen
NORMAL_95 = 1.96  # half of a 95 % interval in standard deviations


@dataclass(frozen=True)
class ReferenceSample:
    """A solid and a tip that are known.

    Parameters
    ----------
    reduced_modulus
        E_r of solid and tip together [GPa].
    area
        Area function of the tip.
    uncertainty
        Relative standard deviation of beta E_r sqrt(A).
    """

    reduced_modulus: float
    area: AreaFunction
    uncertainty: float

    def compliance(self, contact_depth: float) -> float:
        """Return the compliance of the contact [nm/mN] at a contact depth [nm]."""
        area = float(self.area.area(np.array(contact_depth)))
        return float(1e6 * np.sqrt(np.pi) / (2 * BETA * self.reduced_modulus * np.sqrt(area)))


def frame_of_reference(tests: Sequence[tuple[np.ndarray, np.ndarray]], reference: ReferenceSample) -> FrameCompliance:
    """Return the frame's compliance from the unloading of each test from its largest load.

    The interval holds the scatter between tests, and 1.96 times what the reference is uncertain by. One test alone
    shows no scatter: the reference's uncertainty must then be large enough to hold it.

    Parameters
    ----------
    tests
        Load [mN] and depth [nm] (n,) of each.
    """
    found, contacts = np.array([_of_one(load, depth, reference) for load, depth in tests]).T
    count, centre = len(found), float(np.mean(found))
    scatter = stats.t.ppf(0.975, count - 1) * np.std(found, ddof=1) / np.sqrt(count) if count > 1 else 0.0
    half = float(np.hypot(scatter, NORMAL_95 * reference.uncertainty * np.mean(contacts)))
    return FrameCompliance(centre, centre - half, centre + half, count)


def _of_one(load: np.ndarray, depth: np.ndarray, reference: ReferenceSample) -> tuple[float, float]:
    """Return compliances of frame and contact [nm/mN].

    What was found of the frame is taken off, so that unloading is a power law, and found anew.
    """
    last = last_at_peak(load)
    frame, contact = 0.0, 0.0
    for _ in range(ROUNDS):
        left = depth - frame * load
        seen = 1.0 / fit_unloading(load, left).stiffness
        contact = reference.compliance(float(left[last]) - EPSILON * float(load[last]) * (contact or seen))
        frame += seen - contact
    return frame, contact
