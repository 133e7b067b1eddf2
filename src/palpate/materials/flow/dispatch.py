"""One compiled function for all fluidities, and one for all yield stresses: a row of numbers says which."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from numba import njit

from palpate.materials import LAWS
from palpate.materials.flow.registry import FLUIDITIES, STRENGTHS

assert LAWS  # the laws' files, once read, have filled the registry


def _fluidity(functions: Mapping[int, Callable[..., Any]]) -> Any:
    """Return a function of (number, law, at, q, log_q, pressure) that calls the one of the `number`."""
    (number, function), *others = functions.items()
    own = njit(forceinline=True)(function)
    if not others:
        return njit(forceinline=True)(lambda chosen, law, at, q, log_q, pressure: own(law, at, q, log_q, pressure))
    following = _fluidity(dict(others))

    @njit(forceinline=True)
    def choose(chosen, law, at, q, log_q, pressure):
        if chosen == number:
            return own(law, at, q, log_q, pressure)
        return following(chosen, law, at, q, log_q, pressure)

    return choose


def _strength(functions: Mapping[int, Callable[..., Any]]) -> Any:
    """Return a function of (number, law, at, alpha, pressure) that calls the one of the `number`."""
    (number, function), *others = functions.items()
    own = njit(forceinline=True)(function)
    if not others:
        return njit(forceinline=True)(lambda chosen, law, at, alpha, pressure: own(law, at, alpha, pressure))
    following = _strength(dict(others))

    @njit(forceinline=True)
    def choose(chosen, law, at, alpha, pressure):
        if chosen == number:
            return own(law, at, alpha, pressure)
        return following(chosen, law, at, alpha, pressure)

    return choose


fluidity_of = _fluidity(FLUIDITIES)
strength_of = _strength(STRENGTHS)
