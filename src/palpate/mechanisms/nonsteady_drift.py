r"""Decaying drift: tip and specimen reach one temperature only while the test runs.

A difference of temperature between two bodies in contact decays exponentially, and so does the rate of their expansion.
The depth gains

$$\mathrm{rate} \cdot t + \mathrm{amplitude} \, (1 - \exp(-t / \mathrm{time})),$$

whose rate begins at rate + amplitude / time [nm/s] and ends at the steady rate. Rate and amplitude follow the
temperatures at which a test begins, so each recording has its own; the time belongs to the instrument and is the same
in all.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform, signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.mechanisms.thermal_drift import SHARE, plausible_rates


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add rate * t + amplitude * (1 - exp(-t / time)).

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth + values["rate"] * time - values["amplitude"] * np.expm1(-time / values["time"])


MECHANISM = Mechanism(
    key="nonsteady_drift",
    title="decaying drift",
    family="drift",
    effect="depth gains rate * t + amplitude * (1 - exp(-t / time))",
    parameters=(
        Parameter("rate", r"\dot d", "nm/s", -100.0, 100.0, "drift rate of one recording, once it is steady"),
        Parameter("amplitude", "d_0", "nm", -1e5, 1e5, "total drift of one recording in excess of the steady one"),
        Parameter("time", r"\tau_d", "s", 1e-3, 1e6, "time in which the excess rate falls to 37 %"),
    ),
    neutral={"rate": 0.0, "amplitude": 0.0, "time": 20.0},
    example={"rate": 0.05, "amplitude": 8.0, "time": 10.0},
    source="Everitt, Davies & Smith, Philos. Mag. 91 (2011) 1221-1244 (isothermal contact)",
    plausible=lambda s: {
        "rate": plausible_rates(s),
        "amplitude": Range(-0.3 * s.depth, 0.3 * s.depth, typical=SHARE * s.depth),
        "time": Range(0.3 * s.loading_time, s.duration, log=True, least=0.1 * s.loading_time),
    },
    concealed=lambda rng: {
        "rate": signed(rng, 0.005, 0.3),
        "amplitude": signed(rng, 1.0, 30.0),
        "time": log_uniform(rng, 5.0, 60.0),
    },
    record=record,
    varies=True,
    breaks=frozenset({Assumption.NO_DRIFT, Assumption.STEADY_DRIFT}),
    remedy="a wait in contact at a few per cent of the load, before loading, until the depth changes steadily",
    includes=("thermal_drift",),
    by_default=False,
)
