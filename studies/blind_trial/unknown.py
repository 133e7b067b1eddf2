"""Effects that no library holds, made in the virtual laboratory alone, to see whether the tool admits not knowing.

Each takes the curve of a simulated test and returns what an instrument would have recorded; `strength` is 0 to 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate.study.protocol import Protocol


@dataclass(frozen=True, eq=False)
class Curve:
    """A simulated test.

    Parameters
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm]
    protocol
        Its load history.
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    protocol: Protocol


Unknown = Callable[[Curve, float, np.random.Generator], np.ndarray]


def logarithmic_creep(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Creep on with the logarithm of time, as in structural relaxation of glasses (Struik 1978)."""
    share = np.sqrt(test.load / test.protocol.max_load)
    return test.depth * (1.0 + 0.03 * strength * share * np.log1p(test.time / 0.5))


def warming(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Let the modulus fall while the room warms, swinging over a few hundred seconds."""
    softening = 0.12 * strength * np.sin(2 * np.pi * test.time / 170.0) ** 2
    return test.depth * np.sqrt(1.0 + softening)


def stick_slip(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Jump ahead at random loads, as in serrated flow."""
    jumps = np.zeros_like(test.depth)
    for place in np.sort(rng.uniform(0.1, 0.9, 5)):
        k = int(place * len(jumps))
        jumps[k:] += 0.02 * strength * test.depth.max() * rng.uniform(0.5, 1.5)
    return test.depth + jumps


def poroelastic(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Drain fluid from under the tip: relaxation whose time grows with the square of the contact radius (Biot)."""
    drainage = 20.0 * (test.depth.max() / 500.0) ** 2
    return test.depth * (1.0 + 0.15 * strength * (1.0 - np.exp(-np.sqrt(test.time / drainage))))


def load_cell(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Let the gain of the load cell fall with the load, so that the true load is smaller than the recorded one."""
    gain = 1.0 - 0.15 * strength * np.tanh(test.load / 2.0)
    return test.depth * np.sqrt(gain)


UNKNOWN: dict[str, Unknown] = {
    "logarithmic_creep": logarithmic_creep,
    "warming": warming,
    "stick_slip": stick_slip,
    "poroelastic": poroelastic,
    "load_cell": load_cell,
}
