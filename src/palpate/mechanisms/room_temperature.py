r"""Swing of the room's temperature: instrument and specimen breathe with the air conditioning.

The depth gains

$$\mathrm{amplitude} \cdot \sin(2 \pi t / \mathrm{period}) + \mathrm{cosine} \cdot \cos(2 \pi t / \mathrm{period}),$$

a swing of one period whose phase is that at which a test happened to begin. So each recording has both amplitudes for
itself, and their means over many recordings are zero. A period far beyond the tests leaves a drift.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform, signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.mechanisms.thermal_drift import SHARE


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add amplitude * sin(2 pi t / period) + cosine * cos(2 pi t / period).

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    angle = 2.0 * np.pi * time / values["period"]
    return depth + values["amplitude"] * np.sin(angle) + values["cosine"] * np.cos(angle)


MECHANISM = Mechanism(
    key="room_temperature",
    title="swing of the room's temperature",
    family="drift",
    effect="depth gains amplitude * sin(2 pi t / period + phase), with a phase of each recording",
    parameters=(
        Parameter("amplitude", "d_s", "nm", -1e5, 1e5, "amplitude of the swing that begins at its middle"),
        Parameter("cosine", "d_c", "nm", -1e5, 1e5, "amplitude of the swing that begins at its top", default=0.0),
        Parameter("period", "T", "s", 1e-3, 1e7, "period of the room's temperature"),
    ),
    neutral={"amplitude": 0.0, "cosine": 0.0, "period": 100.0},
    example={"amplitude": 8.0, "cosine": 0.0, "period": 50.0},
    source="Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, section III (thermal stability of the room)",
    plausible=lambda s: {
        "amplitude": Range(-0.3 * s.depth, 0.3 * s.depth, typical=SHARE * s.depth),
        "cosine": Range(-0.3 * s.depth, 0.3 * s.depth, typical=SHARE * s.depth),
        "period": Range(0.3 * s.duration, 3.0 * s.duration, log=True, least=0.1 * s.duration),
    },
    concealed=lambda rng: {
        "amplitude": signed(rng, 1.0, 30.0),
        "cosine": signed(rng, 1.0, 30.0),
        "period": log_uniform(rng, 50.0, 500.0),
    },
    record=record,
    varies=True,
    averages_out=True,
    breaks=frozenset({Assumption.NO_DRIFT, Assumption.STEADY_DRIFT}),
    remedy="a hold of one period in contact at a few per cent of the load, before loading",
    by_default=False,
)
