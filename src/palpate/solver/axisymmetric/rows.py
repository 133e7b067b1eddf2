"""Arrays of rows of `LANES` doubles, copied whole or in some lanes.

NumPy's assignment and `where` do the same, but numba then compiles broadcasting and the texts of its errors as well,
which takes a fifth of the time of the whole solver.
"""

from __future__ import annotations

import numpy as np

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import LANES, load, splat, store, where_less


@inner_kernel(cache=True)
def copy_rows(source, target):
    """Copy all rows (n, LANES)."""
    for i in range(source.shape[0]):
        store(target, i, load(source, i))


@inner_kernel(cache=True)
def put_rows(source, target, lanes):
    """Copy rows (n, LANES) in some `lanes` (LANES,)."""
    mask = as_vector(lanes)
    for i in range(source.shape[0]):
        store(target, i, where_less(splat(0.5), mask, load(source, i), load(target, i)))


@inner_kernel(cache=True)
def as_vector(mask):
    """Return one for each lane that a `mask` (LANES,) selects, and zero for the others."""
    numbers = np.zeros(LANES)
    for lane in range(LANES):
        if mask[lane]:
            numbers[lane] = 1.0
    return load(numbers, 0)
