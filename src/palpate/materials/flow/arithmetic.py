"""Functions of a number that laws are written with.

Python evaluates them as written. Compiled code takes the implementations registered with numba: those for doubles
here, those for SIMD vectors in `palpate.solver.axisymmetric.lanes`. A law written with them and the operators + - * /
therefore serves one point or the lanes of a vector.
"""

from __future__ import annotations

import math
from typing import Any

from numba import types
from numba.extending import overload


def exponential(x):
    """Return exp(x)."""
    return math.exp(x)


def logarithm(x):
    """Return ln(x) of a normal positive number."""
    return math.log(x)


def log_of_one_plus(x):
    """Return ln(1 + x), with all digits of a small x."""
    return math.log1p(x)


def rough_log(x):
    """Return ln(x), to within 0.06 at least."""
    return math.log(x)


def root(x):
    """Return the square root."""
    return math.sqrt(x)


def magnitude(x):
    """Return the absolute value."""
    return abs(x)


def greatest(x):
    """Return the largest of the lanes of a vector; a number itself."""
    return x


def where_less(a, b, then, otherwise):
    """Return `then` where a < b, else `otherwise`."""
    return then if a < b else otherwise


def constant(x, value):
    """Return a number as what `x` is: a number, or a vector that holds it in all lanes."""
    return value


def entry(row, k):
    """Return number `k` of a row (c,), or that of each lane of rows (c, LANES)."""
    return row[k]


def whole(row, k):
    """Return number `k` of a row as an integer, which all lanes share."""
    return int(row[k])


def _of_numbers(function: Any, arity: int) -> None:
    """Compile a function of `arity` doubles from its own Python source."""

    def implementation(*arguments):
        return function if all(isinstance(argument, types.Number) for argument in arguments) else None

    names: Any = {1: lambda x: implementation(x), 2: lambda x, value: implementation(x, value)}
    overload(function)(names[arity])


for _function in (exponential, logarithm, log_of_one_plus, rough_log, root, magnitude, greatest):
    _of_numbers(_function, 1)
_of_numbers(constant, 2)


@overload(where_less)
def _where_less(a, b, then, otherwise):
    numbers = all(isinstance(argument, types.Number) for argument in (a, b, then, otherwise))
    return where_less if numbers else None


@overload(entry)
def _entry(row, k):
    return entry if isinstance(row, types.Array) and row.ndim == 1 else None


@overload(whole)
def _whole(row, k):
    return whole if isinstance(row, types.Array) and row.ndim == 1 else None
