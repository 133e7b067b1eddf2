"""One compiled function for all fluidities, and one for all yield stresses: a row of numbers says which."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from numba import njit

from palpate.materials import LAWS
from palpate.materials.flow.registry import FLUIDITIES, STRENGTHS

assert LAWS  # the laws' files, once read, have filled the registry


def _chosen(functions: Mapping[int, Callable[..., Any]]) -> Any:
    """Return a function of (number, *arguments) that calls the one of the `number` with the arguments."""
    (number, function), *others = functions.items()
    own = njit(forceinline=True)(function)
    if not others:
        return njit(forceinline=True)(lambda chosen, *arguments: own(*arguments))
    following = _chosen(dict(others))

    @njit(forceinline=True)
    def choose(chosen, *arguments):
        if chosen == number:
            return own(*arguments)
        return following(chosen, *arguments)

    return choose


fluidity_of = _chosen(FLUIDITIES)
strength_of = _chosen(STRENGTHS)
