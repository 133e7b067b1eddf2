"""Compiled functions that only compiled code calls.

numba wraps what it compiles for callers in Python and in C. To unpack the arguments of the solver's functions and to
check them is long code, which took a fifth of the time that the solver needs to be compiled. Inner kernels have no such
wrappers: a call of one from Python ends the process.
"""

from __future__ import annotations

from functools import partial

from numba import njit

inner_kernel = partial(njit, no_cpython_wrapper=True, no_cfunc_wrapper=True)
