"""Classes of things that are alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

Item = TypeVar("Item")


def classes_of(items: Iterable[Item], alike: Callable[[Item, Item], object]) -> list[list[Item]]:
    """Return items by class: each belongs to the first class whose first item it is like."""
    found: list[list[Item]] = []
    for item in items:
        members = next((members for members in found if alike(members[0], item)), None)
        if members is None:
            found.append(members := [])
        members.append(item)
    return found
