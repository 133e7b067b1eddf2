"""A fact about recordings that needs no model of the material, with its interval and what it suggests."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from palpate.mechanisms import MECHANISMS


@dataclass(frozen=True)
class Fact:
    """One fact.

    Parameters
    ----------
    fact
        What was measured, in words.
    estimate, lower, upper
        In the `unit`; 95 % interval.
    points_to
        Mechanisms that move it away from `neutral`; those that the library does not have are left out.
    neutral
        Its value without any of them; None where the material itself moves it, so that it suggests nothing.
    negligible
        How far from there it may lie without counting as an effect.
    """

    fact: str
    estimate: float
    lower: float
    upper: float
    unit: str
    points_to: tuple[str, ...] = ()
    neutral: float | None = 0.0
    negligible: float = 0.0

    @property
    def suggests(self) -> list[str]:
        """The mechanisms to which it points: none where the interval contains what is found without any."""
        if self.neutral is None or self.lower - self.negligible <= self.neutral <= self.upper + self.negligible:
            return []
        return [key for key in self.points_to if key in MECHANISMS]

    def under_tip(self, name: str) -> Fact:
        """Return the same of tests with the tip of this name, whose own effects it suggests; empty for the study's."""
        if not name:
            return self
        own = [f"{key}[{name}]" if key in MECHANISMS and MECHANISMS[key].of_the_tip else key for key in self.points_to]
        return replace(self, fact=f"{self.fact}, with {name}", points_to=tuple(own))

    def row(self) -> dict[str, Any]:
        """Return its content for `diagnosis.json`."""
        values = {name: float(getattr(self, name)) for name in ("estimate", "lower", "upper")}
        return {"fact": self.fact} | values | {"unit": self.unit, "suggests": self.suggests}
