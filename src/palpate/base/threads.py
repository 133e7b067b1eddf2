"""Linear algebra on one thread: the matrices here are too small to gain by more, which wait for each other instead."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def one_thread_each() -> None:
    """Let linear algebra take one thread, unless the environment says otherwise; before numpy is imported.

    With two threads on two busy cores a pyramid took seven times as long as with one.
    """
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")


def on_one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let linear algebra take one thread while a function runs, for callers who have imported numpy already.

    On two busy cores a diagnosis from a notebook took five times as long without.
    """
    limited: Callable[Arguments, Result] = threadpool_limits.wrap(limits=1, user_api="blas")(function)
    return limited
