r"""Linear viscoelastic cones, fast: the depth under loading, hold and unloading by Ting's closed form.

The algorithm is that of `palpate.classical.ting`, compiled. A compliance is anything that gives the integral of the
contact compliance M, see `palpate.classical.viscoelastic_depth`. That of a spectrum of retardation times is a sum of
Voigt elements, so its elastic part is known exactly.
"""

from __future__ import annotations

import math
from typing import Protocol as Interface

import numpy as np
from numba import njit

from palpate.classical.viscoelastic_depth import Compliance, hereditary
from palpate.study.protocol import Protocol

POISSON_RATIO = 0.34
HALF_ANGLE = 70.3  # deg
PER_SQUARE = math.pi / (2.0 * math.tan(math.radians(HALF_ANGLE)))  # h^2 over int M dP
STEPS_A_SAMPLE = 2  # of the integration: corners and samples lie on its grid where segments are multiples of a sample
ELEMENTS = 6  # Voigt elements a decade that stand for a continuous spectrum


class HasIntegral(Interface):
    """A creep compliance M."""

    def integral(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of M from 0 to times (n,) [s/GPa]; zero before."""


def depth(compliance: HasIntegral, protocol: Protocol, steps: int = 0) -> np.ndarray:
    """Return the depth (n,) [nm] of a cone at the sampling times, exact while the contact grows.

    Parameters
    ----------
    compliance
        Of the half-space.
    protocol
        One loading and one unloading, with holds between.
    steps
        Number of equal time steps of the integration; by default `STEPS_A_SAMPLE` for each sample.
    """
    steps = steps or STEPS_A_SAMPLE * len(protocol.sample_time)
    time = np.linspace(0.0, protocol.sample_time[-1], steps + 1)
    square = np.maximum(hereditary(compliance, protocol, time), 0.0)  # type: ignore[arg-type]
    mean = np.diff(compliance.integral(time)) / time[1]
    found = _after_growth(_relaxation(mean), square, protocol.load_at(time))
    grown = np.maximum(hereditary(compliance, protocol, protocol.sample_time), 0.0)  # type: ignore[arg-type]
    growing = protocol.sample_time <= time[np.argmax(square)]
    root = np.where(growing, np.sqrt(grown), np.interp(protocol.sample_time, time, found))
    return 1e3 * math.sqrt(PER_SQUARE) * root


@njit(cache=True)
def _relaxation(mean: np.ndarray) -> np.ndarray:
    """Return psi (n,) of int psi dM = 1 from the means of M (n,) over equal intervals."""
    psi = np.zeros(len(mean))
    for i in range(len(mean)):
        left = 1.0
        for j in range(i):
            left -= (mean[i - j] - mean[i - j - 1]) * psi[j]
        psi[i] = left / mean[0]
    return psi


@njit(cache=True)
def _after_growth(psi: np.ndarray, square: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the root (n + 1,) of int M dP up to its maximum, and from there on what unloading leaves of it."""
    peak, steps = int(np.argmax(square)), len(psi)
    found, sinking = np.sqrt(square), np.zeros(steps)
    for j in range(peak):
        sinking[j] = found[j + 1] - found[j]
    for k in range(peak + 1, steps + 1):
        borne, earlier = 0.0, float(peak)
        for j in range(peak):
            more = psi[k - 1 - j] * (square[j + 1] - square[j])
            if borne + more >= load[k]:
                earlier = j + (load[k] - borne) / more if more > 0.0 else float(j)
                break
            borne += more
        first = int(earlier)
        since = 0.0
        for j in range(first, k - 1):
            since += psi[k - 1 - j] * sinking[j]
        if first < k - 1:
            since -= (earlier - first) * psi[k - 1 - first] * sinking[first]
        sinking[k - 1] = -since / psi[0]
        found[k] = found[k - 1] + sinking[k - 1]
    return found


def burgers(
    youngs_modulus: float, steady_coefficient: float, transient_coefficient: float, retardation_time: float
) -> Compliance:
    """Return the compliance of a Burgers solid: [GPa], [1/(GPa s)], [1/GPa], [s]."""
    elastic = (1.0 - POISSON_RATIO**2) / youngs_modulus
    return Compliance(elastic, 0.5 * steady_coefficient, ((0.5 * transient_coefficient, retardation_time),))


def spectrum(density: np.ndarray, times: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Return Voigt elements (share of the creep, retardation time [s]) of a density (m,) over ln(time) (m,)."""
    return tuple(zip((density / density.sum()).tolist(), times.tolist(), strict=True))


def times_between(shortest: float, longest: float) -> np.ndarray:
    """Return retardation times [s] that cover a range, evenly by their logarithm."""
    return np.geomspace(shortest, longest, max(2, round(ELEMENTS * math.log10(longest / shortest)) + 1))


def log_normal(time: float, decades: float) -> tuple[tuple[float, float], ...]:
    """Return the elements of a log-normal spectrum about a time [s] with a standard deviation in decades."""
    times = times_between(time * 10.0 ** (-3.0 * decades), time * 10.0 ** (3.0 * decades))
    return spectrum(np.exp(-0.5 * (np.log10(times / time) / decades) ** 2), times)


def power(exponent: float, shortest: float, longest: float) -> tuple[tuple[float, float], ...]:
    """Return the elements of a spectrum in proportion to a power of the time, between two times [s].

    Creep goes with that power of time between both, at an exponent of zero with the logarithm of time.
    """
    times = times_between(shortest, longest)
    return spectrum(times**exponent, times)


def cole_cole(time: float, exponent: float) -> tuple[tuple[float, float], ...]:
    """Return the elements of a Voigt element with a fractional dashpot (K. S. and R. H. Cole, 1941)."""
    times = times_between(1e-3 * time, 1e3 * time)
    turned = np.pi * exponent
    return spectrum(np.sin(turned) / (np.cosh(exponent * np.log(times / time)) + np.cos(turned)), times)
