"""What no library holds, in four kinds: other laws, lengths, clocks and reversals.

A law changes depth / sqrt(load) by a functional of the normalised load up to now, the same at all loads, and knows
nothing of what is to come; a length or a load of its own breaks that; a clock goes on whatever the load; what belongs
to a reversal fades after it. Each gives the change (n,) [nm] of a depth at a strength of one; the strength follows from
a wanted misfit, see `studies.claims.sets`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from palpate.classical.viscoelastic_depth import Compliance
from palpate.study.protocol import Protocol
from studies.coverage.creep import cole_cole, depth, log_normal

Departure = Callable[[Protocol, np.ndarray, Compliance, np.random.Generator], np.ndarray]

SLOW = 0.1  # of a test, over which a random walk is smoothed
SLIPS = 3  # in a test
SETTLES = 0.03  # of a test, in which an overshoot fades
BLUNT = 50.0  # nm, below which the square of the depth prevails again
CRACKED = 1.0  # mN, from which on cracks grow
LIGHT = 0.5  # mN, up to which vibration makes a tip sink in


def _with_elements(elements: tuple[tuple[float, float], ...]) -> Departure:
    """Return creep by a spectrum of retardation times (share, time [s]) beside the Burgers solid's."""

    def change(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
        terms = tuple((0.2 * solid.instantaneous * share, time) for share, time in elements)
        return depth(Compliance(solid.instantaneous, solid.rate, (*solid.terms, *terms)), protocol) - curve

    return change


def hardened(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Recover less at unloading than a viscoelastic body, as one that has hardened."""
    peak = int(np.argmax(curve))
    return np.where(np.arange(len(curve)) > peak, curve[peak] - curve, 0.0)


def eyring(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Flow with the hyperbolic sine of the mean pressure (H. Eyring 1936), in units of the elastic body's."""
    time, elastic = np.append(0.0, protocol.sample_time), depth(Compliance(solid.instantaneous, 0.0, ()), protocol)
    pressure = np.divide(elastic, curve, out=np.zeros_like(curve), where=curve > 0.0) ** 2
    return np.cumsum(curve * np.sinh(3.0 * pressure) * np.diff(time))


def cracking(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Grow cracks once a load is reached, which stay open."""
    reached = np.maximum.accumulate(protocol.sample_load)
    return curve * np.maximum(reached - CRACKED, 0.0) / (reached + CRACKED)


def area_function(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Have a tip with an area of 24.5 h^2 + C h^(1/2) (W. C. Oliver, G. M. Pharr 1992)."""
    return -curve / (curve + BLUNT) ** 1.5


def vibration(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Shake the tip, which sinks in further while the load is small."""
    return curve * np.exp(-protocol.sample_load / LIGHT)


def settling(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Creep of the glue under the specimen, with the logarithm of time."""
    return protocol.sample_load * np.log1p(protocol.sample_time / 5.0)


def random_walk(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Wander slowly, alike in the replicates of a test."""
    time = np.append(0.0, protocol.sample_time)
    walk = np.cumsum(np.sqrt(np.diff(time)) * rng.standard_normal(len(curve)))
    return gaussian_filter1d(walk, SLOW * len(curve), mode="nearest")


def slips(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Have a specimen that slips in its mount now and then, by about as much each time."""
    time = protocol.sample_time / protocol.sample_time[-1]
    when, size = rng.random(SLIPS), rng.standard_normal(SLIPS)
    return (time[:, None] > when) @ size


def overshoot(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Go on for a moment where the rate of the load changes."""
    time, rates = protocol.sample_time, np.diff(protocol.knot_drive) / np.diff(protocol.knot_time)
    settling, found = SETTLES * time[-1], np.zeros(len(curve))
    for corner, before, after in zip(protocol.knot_time[1:-1], rates[:-1], rates[1:], strict=True):
        since = np.maximum(time - corner, 0.0) / settling
        found += (before - after) * since * np.exp(-since)
    return found


def ringing(protocol: Protocol, curve: np.ndarray, solid: Compliance, rng: np.random.Generator) -> np.ndarray:
    """Swing about the course of the load after each of its corners."""
    time, settling_time, found = protocol.sample_time, SETTLES * protocol.sample_time[-1], np.zeros(len(curve))
    for corner in protocol.knot_time[1:-1]:
        since = np.maximum(time - corner, 0.0) / settling_time
        found += np.sin(2.0 * since) * np.exp(-0.5 * since)
    return found


DEPARTURES: dict[str, dict[str, Departure]] = {
    "scaling": {
        "log_normal": _with_elements(log_normal(20.0, 1.0)),
        "cole_cole": _with_elements(cole_cole(20.0, 0.5)),
        "logarithmic": _with_elements(tuple((1.0 / 3.0, float(time)) for time in np.geomspace(0.5, 5e3, 13))),
        "hardened": hardened,
        "eyring": eyring,
    },
    "length": {"cracking": cracking, "area_function": area_function, "vibration": vibration, "settling": settling},
    "clock": {"random_walk": random_walk, "slips": slips},
    "reversal": {"overshoot": overshoot, "ringing": ringing},
}
