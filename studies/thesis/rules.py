"""When a claim of the thesis counts as reproduced.

Every rule is stated beside the thesis' number and shown beside the verdict. A number that the thesis prints is given a
tolerance in its own unit; one that it reads off a figure ("about") must be met within a factor of two; an order or a
pattern must be the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FACTOR = 2.0


@dataclass(frozen=True)
class Rule:
    """What must hold, and whether it does.

    Parameters
    ----------
    statement
        For people.
    holds
        Whether it does.
    """

    statement: str
    holds: bool


def near(found: float, stated: float, tolerance: float) -> Rule:
    """Return the rule that a number lies within `tolerance` of the stated one, all in the same unit."""
    return Rule(f"{stated:g} +- {tolerance:g}", bool(abs(found - stated) <= tolerance))


def about(found: float | Sequence[float], low: float, high: float | None = None) -> Rule:
    """Return the rule that one or several numbers lie within a factor of two of a stated number or range."""
    least, largest = low / FACTOR, FACTOR * (low if high is None else high)
    inside = np.all((np.asarray(found) >= least) & (np.asarray(found) <= largest))
    return Rule(f"within a factor of two: {least:.3g} to {largest:.3g}", bool(inside))


def at_least(found: float | Sequence[float], limit: float) -> Rule:
    """Return the rule that one or several numbers are no smaller than a limit."""
    return Rule(f"at least {limit:g}", bool(np.all(np.asarray(found) >= limit)))


def at_most(found: float | Sequence[float], limit: float) -> Rule:
    """Return the rule that one or several numbers are no larger than a limit."""
    return Rule(f"at most {limit:g}", bool(np.all(np.asarray(found) <= limit)))


def rising(found: Sequence[float]) -> Rule:
    """Return the rule that each number is larger than the one before."""
    return Rule("each larger than the one before", bool(np.all(np.diff(found) > 0)))


def falling(found: Sequence[float]) -> Rule:
    """Return the rule that each number is smaller than the one before."""
    return Rule("each smaller than the one before", bool(np.all(np.diff(found) < 0)))


def both(first: Rule, second: Rule) -> Rule:
    """Return the rule that two rules hold."""
    return Rule(f"{first.statement}; {second.statement}", first.holds and second.holds)
