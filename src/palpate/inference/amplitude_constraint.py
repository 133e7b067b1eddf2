r"""What an exact law says of one mechanism's amplitude, as a datum beside the curves.

A law gives the amplitude :math:`a` independently of the curves' shape, with a likelihood of its own,

    -2 log p = ((a - estimate) / sigma)^2,

which joins that of the curves in the fit, in the posterior and in the evidence. An explanation without the mechanism
has a = 0 to within the background b that its mechanism declares. With a Gaussian a of the standard deviation b the
likelihood is

    -2 log p = estimate^2 / (sigma^2 + b^2) + log(1 + b^2 / sigma^2).

The interval may be wider on one side than on the other; sigma is that of the side on which a lies. An upper bound
constrains one side only: below it the likelihood is constant. A law does not apply to an explanation in which a
mechanism breaks its assumptions: a film changes unloadings as a frame does.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from palpate.classical.reference_sample import NORMAL_95
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS

LEAST = 1e-9  # in the parameter's unit, the narrowest side of an interval: none is so narrow, and none divides by zero


@dataclass(frozen=True)
class AmplitudeConstraint:
    """The amplitude of one mechanism by an exact law.

    Parameters
    ----------
    key, parameter
        Mechanism and its amplitude.
    estimate, lower, upper
        In the parameter's unit; 95 % interval. For a bound, the estimate is the bound and `lower` is minus infinity.
    source
        How it was obtained, in words.
    void_with
        Mechanisms that break its assumptions.
    """

    key: str
    parameter: str
    estimate: float
    lower: float
    upper: float
    source: str
    void_with: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.lower <= self.estimate <= self.upper:
            raise InputError(
                f"{self.key}: {self.estimate} lies outside {self.lower} to {self.upper}", remedy="order the interval"
            )

    @property
    def quantity(self) -> str:
        """What it measures, ``key.name``."""
        return f"{self.key}.{self.parameter}"

    def holds_under(self, mechanisms: Iterable[str]) -> bool:
        """Return whether none of the mechanisms breaks its assumptions."""
        return not set(self.void_with).intersection(mechanisms)

    def weight(self, value: float) -> float:
        """Return 1 / sigma of the side on which `value` lies; zero below a bound."""
        side = self.upper - self.estimate if value > self.estimate else self.estimate - self.lower
        return NORMAL_95 / max(side, LEAST)

    def departure(self, value: float, background: float = 0.0) -> float:
        """Return (value - estimate) / sigma, with `background` added in quadrature to sigma; zero below a bound."""
        weight = self.weight(value)
        return (value - self.estimate) * weight / float(np.hypot(1.0, background * weight)) if weight else 0.0

    def allows(self, value: float, deviation: float) -> bool:
        """Return whether a value with the given standard deviation agrees within 95 %."""
        return abs(self.departure(value, deviation)) <= NORMAL_95

    def row(self) -> dict[str, Any]:
        """Return its content for tables; an end that a bound does not have is None."""
        content = asdict(self) | {"void_with": ", ".join(self.void_with)}
        return {name: None if value == -np.inf else value for name, value in content.items()}


def widenings(constraints: Sequence[AmplitudeConstraint], explanation: Iterable[str]) -> np.ndarray:
    """Return log(1 + b^2 / sigma^2) of each constraint (m,).

    It is zero for bounds, for constraints that do not apply, and where the mechanism acts.
    """
    keys = set(explanation)
    counts = [each.key not in keys and each.holds_under(keys) and np.isfinite(each.lower) for each in constraints]
    ratios = [MECHANISMS[each.key].background * each.weight(0.0) for each in constraints]
    return np.log1p(np.multiply(counts, ratios) ** 2)


def departures(constraints: Sequence[AmplitudeConstraint], amplitudes: Mapping[str, Mapping[str, float]]) -> np.ndarray:
    """Return the departures (m,) [standard deviations] of amplitudes from each constraint; zero where it is void.

    Without the mechanism its amplitude is zero, to within what counts as background.
    """

    def departure(each: AmplitudeConstraint) -> float:
        if not each.holds_under(amplitudes):
            return 0.0
        if each.key in amplitudes:
            return each.departure(amplitudes[each.key][each.parameter])
        return each.departure(0.0, MECHANISMS[each.key].background)

    return np.array([departure(each) for each in constraints])
