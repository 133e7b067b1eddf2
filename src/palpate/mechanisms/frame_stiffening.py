r"""Stiffening frame: joints of the load frame close under the load, so its compliance falls as the load rises.

The depth gains

$$\mathrm{compliance} \cdot P_0 \, (1 - \exp(-P / P_0)),$$

whose slope is the compliance at small loads and falls to 37 % of it at the load $P_0$. Far above the loads of the
tests, $P_0$ makes it a frame of constant compliance.
"""

from __future__ import annotations

import numpy as np

from palpate.base.parameters import Parameter
from palpate.mechanisms import frame_compliance
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform, signed
from palpate.mechanisms.mechanism import Mechanism, Range, Values


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add compliance * load_0 * (1 - exp(-load / load_0)).

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth - values["compliance"] * values["load"] * np.expm1(-load / values["load"])


MECHANISM = Mechanism(
    key="frame_stiffening",
    title="stiffening frame",
    family="frame",
    effect="depth gains compliance * load_0 * (1 - exp(-load / load_0))",
    parameters=(
        Parameter("compliance", "C_f", "nm/mN", -1000.0, 1000.0, "compliance of the frame at small loads"),
        Parameter("load", "P_0", "mN", 1e-6, 1e12, "load at which the compliance has fallen to 37 %"),
    ),
    neutral={"compliance": 0.0, "load": 1e12},
    example={"compliance": 10.0, "load": 0.5},
    source="Van Vliet, Prchlik & Smith, J. Mater. Res. 19 (2004) 325-331 (direct measurement of a frame)",
    plausible=lambda s: {
        **frame_compliance.plausible(s),
        "load": Range(0.1 * s.load, 3.0 * s.load, log=True, least=0.01 * s.load),
    },
    concealed=lambda rng: {"compliance": signed(rng, 0.5, 15.0), "load": log_uniform(rng, 0.5, 10.0)},
    record=record,
    breaks=frozenset({Assumption.ONE_COMPLIANCE}),
    unidentifiable_at_one_load=True,
    remedy="four or more unloadings from loads that span a factor of ten, within each test",
    includes=("frame_compliance",),
    by_default=False,
    of_the_instrument=True,
)
