"""The functions that laws flow by, each known by a number that follows from its name."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

FLUIDITIES: dict[int, Callable[..., Any]] = {}
STRENGTHS: dict[int, Callable[..., Any]] = {}


def number_of(function: Callable[..., Any]) -> int:
    """Return the number of a function."""
    return zlib.crc32(function.__name__.encode())


def fluidity(function: Function) -> Function:
    """Register a fluidity phi: flow at the rate phi s, or a Voigt element that tends to the strain phi s.

    The function takes ``(law, at, q, log_q, pressure, alpha, gain)``: a row whose numbers begin at `at`, the invariant
    q = sqrt(s:s/2) [GPa] with its logarithm, and the pressure [GPa], positive in compression. It returns phi
    [1/GPa/s or 1/GPa], its first and second derivative by ln q, and its derivative by the pressure. Where flow hardens
    by its own equivalent strain, phi holds at the strain alpha + gain phi; the gain is in proportion to q.
    """
    return _entered(function, FLUIDITIES)


def strength(function: Function) -> Function:
    """Register a yield stress: plastic flow keeps the von Mises stress sqrt(3) q at it.

    The function takes ``(law, at, alpha, pressure)`` with the equivalent plastic strain alpha. It returns the stress
    [GPa] and its derivatives by alpha [GPa] and by the pressure.
    """
    return _entered(function, STRENGTHS)


def _entered(function: Function, table: dict[int, Callable[..., Any]]) -> Function:
    number = number_of(function)
    if number in table:
        raise ValueError(f"two functions of laws are called {function.__name__}")
    table[number] = function
    return function
