"""Linear algebra on one thread: the matrices here are too small to gain by more, which wait for each other instead."""

from __future__ import annotations

import os


def one_thread_each() -> None:
    """Let linear algebra take one thread, unless the environment says otherwise; before numpy is imported.

    With two threads on two busy cores a pyramid took seven times as long as with one.
    """
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
