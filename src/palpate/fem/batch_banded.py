"""Cholesky's factorisation of `LANES` symmetric banded matrices at once, each with two right-hand sides."""

from __future__ import annotations

from numba import njit

from palpate.fem.batch_vector import load, root, store


@njit(cache=True)
def solve(band, size, bandwidth, first, second):
    """Overwrite `first` and `second` (size, LANES) with the solutions, and `band` with the factor.

    ``band[j * (bandwidth + 1) + i - j]`` holds the entry (i, j) of the lower half. A lane whose matrix is not positive
    definite becomes NaN.
    """
    width = bandwidth + 1
    for j in range(size):
        top, below = j * width, min(width, size - j)
        inverse = 1.0 / root(load(band, top))
        store(band, top, inverse)
        x, y = load(first, j) * inverse, load(second, j) * inverse
        store(first, j, x)
        store(second, j, y)
        for i in range(1, below):
            entry = load(band, top + i) * inverse
            store(band, top + i, entry)
            store(first, j + i, load(first, j + i) - entry * x)
            store(second, j + i, load(second, j + i) - entry * y)
        for k in range(1, below):
            factor, target = load(band, top + k), (j + k) * width - k
            for i in range(k, below):
                store(band, target + i, load(band, target + i) - factor * load(band, top + i))
    for j in range(size - 1, -1, -1):
        top = j * width
        x, y = load(first, j), load(second, j)
        for i in range(1, min(width, size - j)):
            entry = load(band, top + i)
            x = x - entry * load(first, j + i)
            y = y - entry * load(second, j + i)
        inverse = load(band, top)
        store(first, j, x * inverse)
        store(second, j, y * inverse)
