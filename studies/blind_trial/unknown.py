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


def settling(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Let the glue under the specimen creep under the load, with the logarithm of time."""
    share = test.load / test.protocol.max_load
    return test.depth + 0.03 * strength * test.depth.max() * share * np.log1p(test.time / 5.0)


def cracking(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Let cracks grow from the contact once a load is reached; they stay open."""
    reached = np.maximum.accumulate(test.load) / test.protocol.max_load
    begin = rng.uniform(0.2, 0.5)
    return test.depth * (1.0 + 0.15 * strength * np.maximum(reached - begin, 0.0) ** 2)


def poroelastic(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Drain fluid from under the tip: relaxation whose time grows with the square of the contact radius (Biot)."""
    drainage = 20.0 * (test.depth.max() / 500.0) ** 2
    return test.depth * (1.0 + 0.15 * strength * (1.0 - np.exp(-np.sqrt(test.time / drainage))))


def vibration(test: Curve, strength: float, rng: np.random.Generator) -> np.ndarray:
    """Shake the tip, which then sinks in as under its largest load, most where the mean load is small."""
    share = test.load / test.protocol.max_load
    return test.depth + 0.3 * strength * test.depth.max() * share * np.exp(-6.0 * share)


UNKNOWN: dict[str, Unknown] = {
    "logarithmic_creep": logarithmic_creep,
    "settling": settling,
    "cracking": cracking,
    "poroelastic": poroelastic,
    "vibration": vibration,
}
