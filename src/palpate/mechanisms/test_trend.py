r"""Trend from test to test: a tip wears, picks up material, or a specimen ages while the recordings are made.

The depth changes by a share of itself from one test to the next: recording number $n$ gains

$$\mathrm{rate} \cdot (n - \bar n) \, h,$$

with the mean number $\bar n$ of all recordings. A recording says its place in that order by a line
``# test_number: N``. Where the tests of each kind are spread evenly over the order, only replicates differ, and these
count as scatter between sites; where they are made one kind after the other, the trend looks like a dependence on load
or time.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values

TYPICAL = 0.001  # of the depth in each test; chosen


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add rate * depth, what one test later differs.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return (1.0 + values["rate"]) * depth


MECHANISM = Mechanism(
    key="test_trend",
    title="trend from test to test",
    family="order",
    effect="depth changes by rate * depth from test to test, in the order of the recordings",
    parameters=(Parameter("rate", "r", "-", -0.5, 0.5, "change of the depth from test to test, as a share of it"),),
    neutral={"rate": 0.0},
    example={"rate": 0.01},
    source="ISO 14577-2:2015 (change of the indenter in use)",
    plausible=lambda s: {"rate": Range(-0.05, 0.05, typical=TYPICAL)},
    concealed=lambda rng: {"rate": signed(rng, 0.001, 0.01)},
    record=record,
    follows_depth=True,
    by_test_order=True,
    remedy="the first test again after all others",
    by_default=False,
)
