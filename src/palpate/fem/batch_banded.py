"""Cholesky's factorisation of `LANES` symmetric banded matrices at once, each with two right-hand sides.

Four columns are eliminated together, so that what lies to their right is loaded and stored once for four of them.
"""

from __future__ import annotations

from numba import njit

from palpate.fem.batch_vector import load, root, store

PANEL = 4


@njit(cache=True)
def solve(band, size, width, first, second):
    """Overwrite `first` and `second` (size, LANES) with the solutions, and `band` with the factor.

    Parameters
    ----------
    band : ndarray, shape (size * width, LANES) or longer
        ``band[j * width + i - j]`` holds the entry (i, j) of the lower half.
    width
        Half bandwidth plus `PANEL`: the last `PANEL` - 1 entries of each column are zero.

    A lane whose matrix is not positive definite becomes NaN.
    """
    reach = width - PANEL
    for j in range(0, size, PANEL):
        if j + PANEL > size:
            for c in range(j, size):
                _eliminate(band, width, first, second, c, size, size)
            break
        end = min(j + PANEL + reach, size)
        for c in range(j, j + PANEL):
            _eliminate(band, width, first, second, c, j + PANEL, end)
        _eliminate_panel(band, width, first, second, j, end)
    for j in range(size - 1, -1, -1):
        top = j * width - j
        x, y = load(first, j), load(second, j)
        for i in range(j + 1, min(j + reach + 1, size)):
            entry = load(band, top + i)
            x = x - entry * load(first, i)
            y = y - entry * load(second, i)
        inverse = load(band, top + j)
        store(first, j, x * inverse)
        store(second, j, y * inverse)


@njit(cache=True)
def _eliminate(band, width, first, second, j, last, end):
    """Finish column `j` down to row `end`, and take it from what lies above row `last` to its right."""
    top = j * width - j
    inverse = 1.0 / root(load(band, top + j))
    store(band, top + j, inverse)
    x, y = load(first, j) * inverse, load(second, j) * inverse
    store(first, j, x)
    store(second, j, y)
    for i in range(j + 1, min(j + width, end)):
        store(band, top + i, load(band, top + i) * inverse)
    for c in range(j + 1, last):
        factor, target = load(band, top + c), c * width - c
        store(first, c, load(first, c) - factor * x)
        store(second, c, load(second, c) - factor * y)
        for i in range(c, min(j + width, end)):
            store(band, target + i, load(band, target + i) - factor * load(band, top + i))


@njit(cache=True)
def _eliminate_panel(band, width, first, second, j, end):
    """Take the finished columns `j` to `j` + 3 from what lies to their right, down to row `end`."""
    top0 = j * width - j
    top1, top2, top3 = top0 + width - 1, top0 + 2 * (width - 1), top0 + 3 * (width - 1)
    x0, x1, x2, x3 = load(first, j), load(first, j + 1), load(first, j + 2), load(first, j + 3)
    y0, y1, y2, y3 = load(second, j), load(second, j + 1), load(second, j + 2), load(second, j + 3)
    for c in range(j + PANEL, end):
        f0, f1, f2, f3 = load(band, top0 + c), load(band, top1 + c), load(band, top2 + c), load(band, top3 + c)
        store(first, c, load(first, c) - (f0 * x0 + f1 * x1) - (f2 * x2 + f3 * x3))
        store(second, c, load(second, c) - (f0 * y0 + f1 * y1) - (f2 * y2 + f3 * y3))
        target = c * width - c
        for i in range(c, end):
            value = load(band, target + i) - f0 * load(band, top0 + i) - f1 * load(band, top1 + i)
            value = value - f2 * load(band, top2 + i) - f3 * load(band, top3 + i)
            store(band, target + i, value)
