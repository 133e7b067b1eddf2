r"""Oliver and Pharr's analysis of unloading: stiffness, contact depth, hardness, modulus.

    P = B (h - h_f)^m      S = dP/dh at h_max      h_c = h_max - eps P_max / S      H = P_max / A(h_c)
    E_r = sqrt(pi) S / (2 beta sqrt(A))            1/E_r = (1 - nu^2)/E + (1 - nu_i^2)/E_i

(Oliver and Pharr 1992, J. Mater. Res. 7, 1564; 2004, J. Mater. Res. 19, 3). It assumes that unloading is elastic and
that the surface sinks in as around an elastic contact: piled-up and creeping materials violate one or the other.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares

from palpate.classical.creep import corrected_stiffness
from palpate.errors import InputError
from palpate.study.area_function import AreaFunction

EPSILON = 0.75  # of a paraboloid of revolution (Oliver & Pharr 1992)
BETA = 1.034  # of a flat triangular punch (King, Int. J. Solids Struct. 23 (1987) 1657-1664)
WINDOW = (0.98, 0.25)  # of the largest load, between which unloading is fitted
DIAMOND = (1141.0, 0.07)  # E_i [GPa] and nu_i (Oliver & Pharr 1992)
LOWEST, HIGHEST = (-10.0, 1e-9, 1.0), (2.0, 20.0, 8.0)  # of h_f and the recovery, in largest depths, and of m


@dataclass(frozen=True)
class Unloading:
    """A power law fitted to unloading.

    Parameters
    ----------
    exponent
        m.
    stiffness
        dP/dh at the largest depth of the fit [mN/nm].
    """

    exponent: float
    stiffness: float


@dataclass(frozen=True)
class TipConstants:
    """Area function and constants of a tip.

    Parameters
    ----------
    area
        Area function; that of an ideal Berkovich by default.
    beta, epsilon
        Factors of the stiffness relation (1 for a cone) and of the contact depth.
    elastic
        Modulus [GPa] and Poisson's ratio; None for a rigid tip.
    """

    area: AreaFunction = field(default_factory=AreaFunction)
    beta: float = BETA
    epsilon: float = EPSILON
    elastic: tuple[float, float] | None = DIAMOND

    @property
    def compliance(self) -> float:
        """Inverse plane-strain modulus [1/GPa]; zero for a rigid tip."""
        return 0.0 if self.elastic is None else (1 - self.elastic[1] ** 2) / self.elastic[0]


@dataclass(frozen=True)
class OliverPharr:
    """Outcome of the analysis.

    Parameters
    ----------
    stiffness
        Contact stiffness used [mN/nm].
    contact_depth
        [nm]
    area
        [nm^2]
    hardness, reduced_modulus, modulus
        [GPa]
    exponent
        Of the unloading power law.
    """

    stiffness: float
    contact_depth: float
    area: float
    hardness: float
    reduced_modulus: float
    modulus: float
    exponent: float


def last_at_peak(load: np.ndarray) -> int:
    """Return the last point of a load (n,) that is within a thousandth of the largest: where unloading begins."""
    return len(load) - 1 - int(np.argmax(load[::-1] > 0.999 * load.max()))


def fit_unloading(load: np.ndarray, depth: np.ndarray) -> Unloading:
    """Fit P = B (h - h_f)^m to unloading between 98 and 25 % of the largest load; S is taken at the largest load.

    The fit is to the depth, h = h_f + (P / B)^(1/m), with loads and depths scaled by their largest values. With a nose
    the law cannot hold, and the exponent ends on its upper bound; the stiffness is then that of the best such curve.

    Parameters
    ----------
    load, depth : ndarray, shape (n,)
        [mN], [nm].

    Raises
    ------
    InputError
        When fewer than four points lie between the fractions, no depth is positive, or unloading recovers several times
        the largest depth: a larger frame was taken off than there is, or the depth does not begin at contact.
    """
    begin, scale_p = last_at_peak(load), load.max()
    falling = load[begin:]
    keep = (falling <= WINDOW[0] * falling.max()) & (falling >= WINDOW[1] * falling.max())
    if keep.sum() < 4:
        raise InputError(
            f"unloading has {keep.sum()} points between {WINDOW[0]:.0%} and {WINDOW[1]:.0%} of the largest load",
            remedy="record more points while it is unloaded",
        )
    part, at = falling[keep], depth[begin:][keep]
    scale_h = float(at.max())
    slope = float(np.polynomial.Polynomial.fit(part / scale_p, at, 1).convert().coef[-1]) if np.ptp(part) else 0.0
    if scale_h <= 0.0 or scale_h - 1.4 * slope < LOWEST[0] * scale_h:
        raise InputError(
            f"unloading from {scale_h:.4g} nm cannot recover {slope:.4g} nm",
            remedy="let the depth begin at contact, and take off no more than the frame's part of it",
            place="depth_nm",
        )
    p, h = part / scale_p, at / scale_h

    def predicted(x: np.ndarray) -> np.ndarray:
        return x[0] + x[1] * p ** (1.0 / x[2])

    rise = 1.4 * max(slope / scale_h, 1e-3)
    found = least_squares(
        lambda x: predicted(x) - h,
        [1.0 - rise, rise, 1.4],
        bounds=(LOWEST, HIGHEST),
        x_scale=[0.1, 0.1, 1],
        xtol=1e-12,
    ).x
    rise, exponent = found[1] * scale_h, found[2]
    return Unloading(float(exponent), float(exponent * scale_p / rise))


def oliver_pharr(
    load: np.ndarray,
    depth: np.ndarray,
    poisson_ratio: float,
    *,
    tip: TipConstants | None = None,
    creep: tuple[float, float] | None = None,
) -> OliverPharr:
    """Analyse one recording.

    Parameters
    ----------
    load, depth : ndarray, shape (n,)
        [mN], [nm].
    poisson_ratio
        Of the sample.
    tip
        Area function and constants of the tip; those of an ideal Berkovich of diamond when not given.
    creep
        dh/dt at the end of the hold [nm/s] and |dP/dt| of unloading [mN/s], to correct the stiffness.

    Raises
    ------
    InputError
        When unloading cannot be fitted (`fit_unloading`), the contact depth or area is not positive, or the contact is
        as stiff as the tip allows even on a rigid sample, 1/E_r <= (1 - nu_i^2)/E_i: there is no such modulus.
    """
    unloading, tip = fit_unloading(load, depth), tip or TipConstants()
    stiffness = unloading.stiffness if creep is None else corrected_stiffness(unloading.stiffness, *creep)
    contact_depth = float(depth[last_at_peak(load)] - tip.epsilon * load.max() / stiffness)
    if not contact_depth > 0.0:
        raise InputError(
            f"the contact depth is {contact_depth:.4g} nm",
            remedy="let the depth begin at contact, and take off no more than the frame's part of it",
            place="depth_nm",
        )
    contact_area = float(tip.area.area(np.array(contact_depth)))
    if not contact_area > 0.0:
        raise InputError(
            f"the tip's area is {contact_area:.4g} nm^2 at the contact depth of {contact_depth:.4g} nm",
            remedy="use an area function that was calibrated at the depths of the test",
            place="area",
        )
    reduced = 1e6 * np.sqrt(np.pi) * stiffness / (2 * tip.beta * np.sqrt(contact_area))
    if not 1 / reduced > tip.compliance:
        raise InputError(
            f"the reduced modulus is {reduced:.4g} GPa, which the tip allows on no sample",
            remedy="check the area function, the tip's modulus and what was taken off for the frame",
            place="indenter",
        )
    return OliverPharr(
        stiffness,
        contact_depth,
        contact_area,
        float(1e6 * load.max() / contact_area),
        float(reduced),
        float((1 - poisson_ratio**2) / (1 / reduced - tip.compliance)),
        unloading.exponent,
    )
