"""Classes of things that are alike, and levels of things of like size."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import pairwise
from math import inf
from operator import itemgetter
from typing import TypeVar

Item = TypeVar("Item")
CLEAR_GAP = 1.02  # chosen: ratio of sizes across a gap that is clear
CLEARLY = 5.0  # chosen: gap beside what the levels at its sides span, as logarithms


def classes_of(items: Iterable[Item], alike: Callable[[Item, Item], object]) -> list[list[Item]]:
    """Return items by class: each belongs to the first class whose first item it is like."""
    found: list[list[Item]] = []
    for item in items:
        members = next((members for members in found if alike(members[0], item)), None)
        if members is None:
            found.append(members := [])
        members.append(item)
    return found


def levels(items: Iterable[Item], size: Callable[[Item], float], ratio: float) -> list[list[Item]]:
    """Return items by size: the largest of a level is at most `ratio` times its least, and near sizes join first.

    This is complete linkage on one axis: of neighbouring levels those are joined whose union spans least. Levels of
    several items each stay apart where the gap between them is clear beside what they span.
    """
    ordered = sorted(((size(item), item) for item in items), key=itemgetter(0))
    found, sizes = [[item] for _, item in ordered], [[number] for number, _ in ordered]
    while True:
        spans = [inf if _distinct(*pair) else pair[1][-1] / pair[0][0] for pair in pairwise(sizes)]
        if min(spans, default=inf) > ratio:
            return found
        least = spans.index(min(spans))
        found[least : least + 2] = [found[least] + found[least + 1]]
        sizes[least : least + 2] = [sizes[least] + sizes[least + 1]]


def _distinct(below: list[float], above: list[float]) -> bool:
    """Return whether two levels of sizes in order are clearly apart."""
    gap, inner = above[0] / below[-1], max(below[-1] / below[0], above[-1] / above[0])
    return min(len(below), len(above)) > 1 and gap > max(CLEAR_GAP, inner**CLEARLY)
