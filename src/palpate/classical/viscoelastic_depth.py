r"""Linear viscoelastic indentation under load control: compliances, and the depth while the contact grows.

    cone of half-angle alpha:  h^2     = pi / (2 tan alpha) * int M(t - t') dP(t')
    sphere of radius R:        h^(3/2) = 3 / (4 sqrt R)     * int M(t - t') dP(t')

(Lee and Radok 1960, J. Appl. Mech. 27, 438; Lu et al. 2003, Mech. Time-Depend. Mater. 7, 189) with the contact
compliance M(t) [1/GPa], in the elastic case (1 - nu)/(2 G) = (1 - nu^2)/E. Creep is isochoric, so each part of the
deviatoric creep compliance J enters with the factor 1/2 of an incompressible solid:

    M(t) = (1 - nu^2)/E + (C_s t + sum_k C_k (1 - exp(-t / tau_k))) / 2

(exact for nu = 1/2; at nu = 0.34 the creep parts are 3 % low). For load that is linear in time between knots the
integral has a closed form, a sum over the ramps that have begun. It holds while the contact radius grows; for
unloading see `palpate.classical.ting`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palpate.errors import InputError
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol


@dataclass(frozen=True)
class Model:
    """A spring-and-dashpot model.

    Parameters
    ----------
    elastic, viscous
        Whether it has a spring, and a dashpot, in series with its Voigt elements.
    voigt
        Number of Voigt elements.
    meaning
        For people.
    """

    elastic: bool
    viscous: bool
    voigt: int
    meaning: str

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its parameters, those of the nonlinear Burgers law at zero exponents."""
        found = ("youngs_modulus",) * self.elastic + ("steady_coefficient",) * self.viscous
        for k in range(1, self.voigt + 1):
            tail = f"_{k}" if k > 1 else ""
            found += (f"transient_coefficient{tail}", f"retardation_time{tail}")
        return found


MODELS = {
    "maxwell": Model(True, True, 0, "Maxwell: a spring and a dashpot in series"),
    "kelvin_voigt": Model(False, False, 1, "Kelvin-Voigt: a spring and a dashpot side by side"),
    "standard_linear_solid": Model(True, False, 1, "a spring in series with a Voigt element"),
    "burgers": Model(True, True, 1, "Maxwell in series with a Voigt element"),
    "prony_2": Model(True, False, 2, "Prony series of two terms, no flow"),
}


@dataclass(frozen=True)
class Compliance:
    """Contact compliance M(t) = instantaneous + rate t + sum_k c_k (1 - exp(-t / tau_k)) [1/GPa].

    Parameters
    ----------
    instantaneous, rate
        [1/GPa], [1/(GPa s)]
    terms
        (c_k [1/GPa], tau_k [s]) of each Voigt element.
    """

    instantaneous: float
    rate: float
    terms: tuple[tuple[float, float], ...]

    @classmethod
    def of(cls, values: Mapping[str, float], poisson_ratio: float) -> Compliance:
        """Return the contact compliance of parameters that carry the names of the nonlinear Burgers law."""
        modulus = values.get("youngs_modulus", math.inf)
        terms = []
        for name, value in values.items():
            if name.startswith("transient_coefficient"):
                tau = values["retardation_time" + name.removeprefix("transient_coefficient")]
                terms.append((0.5 * value, tau))
        return cls((1 - poisson_ratio**2) / modulus, 0.5 * values.get("steady_coefficient", 0.0), tuple(terms))

    def at(self, time: np.ndarray) -> np.ndarray:
        """Return M [1/GPa] at times (n,) [s]."""
        value = self.instantaneous + self.rate * time
        for coefficient, tau in self.terms:
            value = value - coefficient * np.expm1(-time / tau)
        return value

    def integral(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of M from 0 to times (n,) [s/GPa]; zero before."""
        time = np.maximum(time, 0.0)
        value = self.instantaneous * time + 0.5 * self.rate * time**2
        for coefficient, tau in self.terms:
            value = value + coefficient * (time + tau * np.expm1(-time / tau))
        return value


def hereditary(compliance: Compliance, protocol: Protocol, time: np.ndarray) -> np.ndarray:
    """Return int M(t - t') dP(t') [mN/GPa = um^2] at times (n,), exactly."""
    rates = np.diff(protocol.knot_load) / np.diff(protocol.knot_time)
    value = np.zeros(len(time))
    for rate, begin, end in zip(rates, protocol.knot_time[:-1], protocol.knot_time[1:], strict=True):
        value += rate * (compliance.integral(time - begin) - compliance.integral(time - end))
    return value


def depth_of(indenter: Indenter, square: np.ndarray) -> np.ndarray:
    """Return depths (n,) [nm] from int M dP (n,) [um^2] under a cone or a sphere; raises `InputError` for others."""
    square = np.maximum(square, 0.0)
    if indenter.shape == "cone":
        return 1e3 * np.sqrt(math.pi / (2 * math.tan(math.radians(indenter.half_angle))) * square)
    if indenter.shape == "sphere":
        return 1e3 * (0.75 / math.sqrt(indenter.radius * 1e-3) * square) ** (2 / 3)
    raise InputError(f"no closed form for a {indenter.shape}", remedy="use a cone or a sphere", place="indenter.shape")


def depth_while_growing(compliance: Compliance, indenter: Indenter, protocol: Protocol) -> np.ndarray:
    """Return the depth (n,) [nm] at the sampling times, true while the contact radius grows."""
    return depth_of(indenter, hereditary(compliance, protocol, protocol.sample_time))
