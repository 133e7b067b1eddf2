r"""Pop-in: the depth jumps once in each test, as where dislocations first form, an oxide breaks or the tip slips.

A recording gains the jump once its load has reached that of the pop-in, and keeps it in unloading. That load is a
matter of chance, another one in each recording. With log-normal loads the recordings of a test gain in the mean

$$\mathrm{jump} \cdot \Phi(\ln(P / P_j) / \mathrm{scatter}),$$

where $P$ is the largest load so far and $\Phi$ the normal distribution. A scatter of zero is a single recording.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from palpate.base.parameters import Parameter
from palpate.mechanisms.draws import log_uniform
from palpate.mechanisms.mechanism import Mechanism, Range, Values

SHARP = 1e-9  # scatter of a single recording


def record(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Add depth_jump times the share of recordings in which the pop-in is over.

    Arguments are those of `palpate.mechanisms.mechanism.unchanged_depth`.
    """
    return depth + values["depth_jump"] * over(load, values)


def over(load: np.ndarray, values: Values) -> np.ndarray:
    """Return the share (n,) of recordings in which the pop-in is over under a load (n,) [mN]."""
    reached = np.maximum.accumulate(np.maximum(load, 0.0))
    with np.errstate(divide="ignore"):
        return ndtr((np.log(reached) - np.log(values["load"])) / values["scatter"])


def course_covariance(time: np.ndarray, load: np.ndarray, values: Values) -> np.ndarray:
    """Return the covariance (n, n) of jumps of 1 nm, each at a load of its own: F_i (1 - F_j) for P_i <= P_j."""
    share = over(load, values)
    return np.minimum.outer(share, share) - np.outer(share, share)


MECHANISM = Mechanism(
    key="pop_in",
    title="pop-in",
    family="jump",
    effect="one jump of the depth in each test, at a load of its own",
    parameters=(
        Parameter("depth_jump", r"\Delta h", "nm", -1e5, 1e5, "jump of the depth"),
        Parameter("load", "P_j", "mN", 1e-9, 1e9, "median load at which it occurs"),
        Parameter("scatter", "s", "-", SHARP, 2.0, "standard deviation of that load's logarithm", default=SHARP),
    ),
    neutral={"depth_jump": 0.0, "load": 1.0, "scatter": 0.1},
    example={"depth_jump": 8.0, "load": 0.3, "scatter": 0.1},
    source="Schuh & Lund, J. Mater. Res. 19 (2004) 2152-2158 (distribution of the load of the first pop-in)",
    plausible=lambda s: {
        "depth_jump": Range(0.0, 0.1 * s.depth),
        "load": Range(0.01 * s.load, s.load, log=True, least=1e-3 * s.load),
        "scatter": Range(0.01, 0.5, log=True, least=0.005),
    },
    concealed=lambda rng: {
        "depth_jump": log_uniform(rng, 2.0, 50.0),
        "load": log_uniform(rng, 0.1, 2.0),
        "scatter": log_uniform(rng, 0.05, 0.3),
    },
    record=record,
    varies=True,
    course_covariance=course_covariance,
    by_default=False,
)
