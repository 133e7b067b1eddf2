"""Thermal drift: instrument and specimen expand at a steady rate while the test runs, so depth gains rate * t.

Every instrument drifts a little. A rate that differs between recordings with a standard deviation of up to 0.01 nm/s
counts as background, not as an effect: Oliver & Pharr began their tests once the rate was below 0.05 nm/s, which is the
typical rate here. What long tests of soft bodies drift by is known by its share of the depth alone.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Scale, Values

TYPICAL = 0.05  # nm/s
SHARE = 0.005  # of the depth, in the longest test


def plausible_rates(scale: Scale) -> Range:
    """Return the rates that leave most of the depth to the specimen."""
    whole = scale.depth / scale.duration
    return Range(-0.3 * whole, 0.3 * whole, typical=min(max(TYPICAL, SHARE * whole), 0.1 * whole))


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add rate * t.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth + values["rate"] * time


MECHANISM = Mechanism(
    key="thermal_drift",
    title="thermal drift",
    family="drift",
    effect="depth gains rate * time",
    parameters=(Parameter("rate", r"\dot d", "nm/s", -100.0, 100.0, "drift rate of one recording"),),
    neutral={"rate": 0.0},
    example={"rate": 0.1},
    source="Oliver & Pharr, J. Mater. Res. 7 (1992) 1564-1583, section III",
    plausible=lambda s: {"rate": plausible_rates(s)},
    concealed=lambda rng: {"rate": signed(rng, 0.005, 0.3)},
    record=record,
    varies=True,
    background=0.01,
    breaks=frozenset({Assumption.NO_DRIFT}),
    remedy="a hold of a minute or more at a few per cent of the load after unloading",
)
