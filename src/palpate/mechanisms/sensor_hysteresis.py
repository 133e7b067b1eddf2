r"""Hysteresis of the depth sensor: on the way back it shows another depth than on the way in.

In each unloading, from the load $P_\mathrm{max}$ at which it begins, the depth gains

$$\mathrm{size} \cdot h_\mathrm{max} \sin(\pi P / P_\mathrm{max}),$$

with the largest depth so far. Both ends of the loop are closed. It follows the depth, so it scales as the response of a
homogeneous body does, and no other load tells it from a law that recovers otherwise; a sensor of another kind does, or
a body whose recovery is known.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import find_peaks

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values

TYPICAL = 0.002  # of the depth, of capacitive and inductive sensors; chosen
SWING = 0.01  # of the largest load, by which it falls in an unloading; smaller falls are noise


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add size * depth_max * sin(pi * load / load_max) in each unloading.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    recorded = depth.copy()
    for begin, end in unloadings(load):
        share = np.clip(load[begin:end] / load[begin], 0.0, 1.0)
        recorded[begin:end] += values["size"] * depth[:end].max() * np.sin(np.pi * share)
    return recorded


def unloadings(load: np.ndarray) -> list[tuple[int, int]]:
    """Return the first sample of each unloading, and the first one after it, of a load (n,)."""
    around = np.concatenate([[-np.inf], load, [-np.inf]])
    swing = SWING * np.abs(load).max(initial=0.0)
    if not swing:
        return []
    peaks = find_peaks(around, prominence=swing)[0] - 1
    troughs = find_peaks(-around[1:-1], prominence=swing)[0]
    ends = [int(troughs[troughs > peak].min(initial=len(load))) for peak in peaks]
    return list(zip(map(int, peaks), ends, strict=True))


MECHANISM = Mechanism(
    key="sensor_hysteresis",
    title="hysteresis of the depth sensor",
    family="sensor",
    effect="depth in unloading gains size * depth_max * sin(pi * load / load_max)",
    parameters=(Parameter("size", "s", "-", -1.0, 1.0, "half-height of the loop, as a share of the largest depth"),),
    neutral={"size": 0.0},
    example={"size": 0.01},
    source="Hues et al., Rev. Sci. Instrum. 65 (1994) 1561-1565 (hysteresis of piezoelectric actuators in indentation)",
    plausible=lambda s: {"size": Range(-0.1, 0.1, typical=TYPICAL)},
    concealed=lambda rng: {"size": signed(rng, 0.002, 0.03)},
    record=record,
    follows_depth=True,
    remedy="a test of an elastic body, such as fused silica under a sphere, whose unloading is its loading",
    by_default=False,
    of_the_instrument=True,
)
