"""Triangular factors of `LANES` banded matrices at once, each with two right-hand sides.

Four columns are eliminated together, so that what lies to their right is loaded and stored once for four of them. A
symmetric matrix is its lower half (Cholesky); of any other the upper half is stored and eliminated likewise, without
pivoting: its symmetric part is expected to be positive definite, which makes that stable (Golub & Van Loan, Matrix
Computations, 4th ed. (2013), section 4.1.4).
"""

from __future__ import annotations

from palpate.base.inner_kernel import inner_kernel
from palpate.solver.axisymmetric.lanes import load, root, store

PANEL = 4  # columns that are eliminated together


@inner_kernel(cache=True)
def solve(lower, upper, size, width, first, second):
    """Overwrite `first` and `second` (size, LANES) with the solutions, and the matrix with its factors.

    Parameters
    ----------
    lower : ndarray, shape (size * width, LANES) or longer
        ``lower[j * width + i - j]`` holds the entry (i, j), where i >= j.
    upper : ndarray
        Likewise ``upper[j * width + i - j]`` the entry (j, i); empty where the matrix is symmetric.
    width
        Half bandwidth plus `PANEL`: the last `PANEL` - 1 entries of each column are zero.

    A lane with a pivot that is not positive becomes NaN.
    """
    reach = width - PANEL
    for j in range(0, size, PANEL):
        if j + PANEL > size:
            for c in range(j, size):
                _eliminate(lower, upper, width, first, second, c, size, size)
            break
        end = min(j + PANEL + reach, size)
        for c in range(j, j + PANEL):
            _eliminate(lower, upper, width, first, second, c, j + PANEL, end)
        _eliminate_panel(lower, upper, width, first, second, j, end)
    across = lower if len(upper) == 0 else upper
    for j in range(size - 1, -1, -1):
        top = j * width - j
        x, y = load(first, j), load(second, j)
        for i in range(j + 1, min(j + reach + 1, size)):
            entry = load(across, top + i)
            x = x - entry * load(first, i)
            y = y - entry * load(second, i)
        inverse = load(lower, top + j)
        store(first, j, x * inverse)
        store(second, j, y * inverse)


@inner_kernel(cache=True)
def solve_again(lower, upper, size, width, right):
    """Overwrite `right` (size, LANES) with the solution of a matrix whose factors `solve` left.

    Parameters
    ----------
    lower, upper, size, width
        See `solve`.
    """
    reach = width - PANEL
    for j in range(size):
        top = j * width - j
        x = load(right, j) * load(lower, top + j)
        store(right, j, x)
        for i in range(j + 1, min(j + reach + 1, size)):
            store(right, i, load(right, i) - load(lower, top + i) * x)
    across = lower if len(upper) == 0 else upper
    for j in range(size - 1, -1, -1):
        top = j * width - j
        x = load(right, j)
        for i in range(j + 1, min(j + reach + 1, size)):
            x = x - load(across, top + i) * load(right, i)
        store(right, j, x * load(lower, top + j))


@inner_kernel(cache=True)
def _eliminate(lower, upper, width, first, second, j, last, end):
    """Finish column and row `j` up to `end`, and take them from what lies before `last` to their right and below."""
    symmetric = len(upper) == 0
    across = lower if symmetric else upper
    top = j * width - j
    inverse = 1.0 / root(load(lower, top + j))
    store(lower, top + j, inverse)
    x, y = load(first, j) * inverse, load(second, j) * inverse
    store(first, j, x)
    store(second, j, y)
    for i in range(j + 1, min(j + width, end)):
        store(lower, top + i, load(lower, top + i) * inverse)
    if not symmetric:
        for i in range(j + 1, min(j + width, end)):
            store(upper, top + i, load(upper, top + i) * inverse)
    for c in range(j + 1, last):
        down, right, target = load(lower, top + c), load(across, top + c), c * width - c
        store(first, c, load(first, c) - down * x)
        store(second, c, load(second, c) - down * y)
        for i in range(c, min(j + width, end)):
            store(lower, target + i, load(lower, target + i) - right * load(lower, top + i))
        if not symmetric:
            for i in range(c + 1, min(j + width, end)):
                store(upper, target + i, load(upper, target + i) - down * load(upper, top + i))


@inner_kernel(cache=True)
def _eliminate_panel(lower, upper, width, first, second, j, end):
    """Take the finished columns and rows `j` to `j` + 3 from what lies to their right and below, up to `end`."""
    symmetric = len(upper) == 0
    across = lower if symmetric else upper
    top0 = j * width - j
    top1, top2, top3 = top0 + width - 1, top0 + 2 * (width - 1), top0 + 3 * (width - 1)
    x0, x1, x2, x3 = load(first, j), load(first, j + 1), load(first, j + 2), load(first, j + 3)
    y0, y1, y2, y3 = load(second, j), load(second, j + 1), load(second, j + 2), load(second, j + 3)
    for c in range(j + PANEL, end):
        f0, f1, f2, f3 = load(lower, top0 + c), load(lower, top1 + c), load(lower, top2 + c), load(lower, top3 + c)
        g0, g1, g2, g3 = load(across, top0 + c), load(across, top1 + c), load(across, top2 + c), load(across, top3 + c)
        store(first, c, load(first, c) - (f0 * x0 + f1 * x1) - (f2 * x2 + f3 * x3))
        store(second, c, load(second, c) - (f0 * y0 + f1 * y1) - (f2 * y2 + f3 * y3))
        target = c * width - c
        for i in range(c, end):
            value = load(lower, target + i) - g0 * load(lower, top0 + i) - g1 * load(lower, top1 + i)
            value = value - g2 * load(lower, top2 + i) - g3 * load(lower, top3 + i)
            store(lower, target + i, value)
        if not symmetric:
            for i in range(c + 1, end):
                value = load(upper, target + i) - f0 * load(upper, top0 + i) - f1 * load(upper, top1 + i)
                value = value - f2 * load(upper, top2 + i) - f3 * load(upper, top3 + i)
                store(upper, target + i, value)
