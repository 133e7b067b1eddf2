"""The linear Burgers solid (m_s = m_t = 0): its creep compliance, and the hereditary integral over a load history.

    e(t) = J(t) s,    J(t) = 1/(2G) + C_s t + sum_k C_t,k (1 - exp(-t/t_eps,k))

J is the deviatoric creep compliance of tensorial strain. Assumes incompressibility (nu = 0.5), for which the
correspondence principle needs no Laplace transform of Poisson's ratio.

Source: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; W. N. Findley, J. S. Lai & K. Onaran, Creep and
Relaxation of Nonlinear Viscoelastic Materials (1976), section 5.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError
from palpate.study.protocol import Protocol


@dataclass(frozen=True)
class LinearBurgers:
    """Creep compliance of the linear, incompressible Burgers solid.

    Parameters
    ----------
    shear_modulus
        G [GPa], positive.
    steady_coefficient
        C_s [1/(GPa s)].
    voigt
        C_t [1/GPa] and t_eps [s] of each Voigt element.

    Raises
    ------
    InputError
        When a modulus or time is not positive, or a coefficient is negative.
    """

    shear_modulus: float
    steady_coefficient: float = 0.0
    voigt: Sequence[tuple[float, float]] = ()

    def __post_init__(self) -> None:
        if self.shear_modulus <= 0 or self.steady_coefficient < 0 or any(c < 0 or t <= 0 for c, t in self.voigt):
            raise InputError(
                "moduli and times must be positive, coefficients not negative", remedy="correct sign or unit"
            )

    def compliance(self, time: np.ndarray) -> np.ndarray:
        """Return J [1/GPa] at `time` [s] >= 0, of the same shape."""
        creep = self.steady_coefficient * time
        return 1 / (2 * self.shear_modulus) + creep + sum(c * -np.expm1(-time / t) for c, t in self.voigt)

    def integrated_compliance(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of J from 0 to `time` [s], in s/GPa; zero where `time` is negative."""
        t = np.maximum(time, 0.0)
        value = t / (2 * self.shear_modulus) + self.steady_coefficient * t**2 / 2
        return value + sum(c * (t + tau * np.expm1(-t / tau)) for c, tau in self.voigt)

    def hereditary_integral(self, protocol: Protocol) -> np.ndarray:
        """Return int_0^t J(t - t') dP(t') in mN/GPa at the protocol's sampling times, shape (n,).

        Exact for a piecewise linear load: every change of the loading rate adds its integrated compliance.

        Raises
        ------
        InputError
            When the load falls before the last sample: the solutions built on this integral hold while contact grows.
        """
        rate = np.diff(protocol.knot_load) / np.diff(protocol.knot_time)
        last = protocol.sample_time[-1]
        if np.any(rate[protocol.knot_time[:-1] < last * (1 - 1e-12)] < 0):
            raise InputError(
                "the load falls before the last sample",
                remedy="end the samples where loading ends",
                place="protocol",
            )
        changes = np.diff(rate, prepend=0.0)
        since = protocol.sample_time[:, None] - protocol.knot_time[None, :-1]
        return self.integrated_compliance(since) @ changes
