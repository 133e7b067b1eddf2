r"""Controller lag: the load on the body follows the recorded one with a delay.

$$P_\mathrm{applied}(t) = P_\mathrm{recorded}(t - \mathrm{lag})$$

Under displacement control the same holds for the displacement.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.base.parameters import Parameter
from palpate.errors import InputError
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values
from palpate.study.protocol import LEAST_STEP
from palpate.study.specification import Specification


def simulate(specification: Specification, values: Values) -> Specification:
    """Delay the history and sample it when the recording does; raises `InputError` where the test ends before.

    A lag that no history can resolve counts as none.
    """
    lag, protocol = values["lag"], specification.protocol
    end = protocol.knot_time[-1]
    if lag < LEAST_STEP * end:
        return specification
    if lag >= end:
        raise InputError(
            f"lag = {lag:g} s is not shorter than the test, which lasts {end:g} s",
            remedy="give a lag that is shorter than every test",
            place="mechanisms.controller_lag.lag",
        )
    late = protocol.knot_time[1:] + lag
    inside = late[late < end * (1.0 - LEAST_STEP)]
    knots = np.concatenate([[0.0, lag], inside, [end]])
    drive = protocol.drive_at(np.maximum(knots - lag, 0.0))
    return replace(specification, protocol=replace(protocol, knot_time=knots, knot_drive=drive))


MECHANISM = Mechanism(
    key="controller_lag",
    title="controller lag",
    family="controller",
    effect="the load on the body follows the recorded one with a delay",
    parameters=(Parameter("lag", r"\delta", "s", 0.0, 1e4, "delay of the applied load, shorter than every test"),),
    neutral={"lag": 0.0},
    example={"lag": 1.0},
    source="Hay, Experimental Techniques 33 (2009) 66-72 (dynamics of load control)",
    plausible=lambda s: {"lag": Range(0.0, min(2.0, 0.1 * s.loading_time))},
    concealed=lambda rng: {"lag": log_uniform(rng, 0.02, 1.0)},
    simulate=simulate,
    breaks=frozenset({Assumption.RECORDED_LOAD_ACTS}),
    of_the_instrument=True,
)
