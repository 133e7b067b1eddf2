r"""Radial kernels: their formulas in a length c, and how SciPy spells them.

SciPy's `RBFInterpolator` scales the distance by its `epsilon` instead of dividing it by a length c. With
epsilon = 1/c its kernels equal these up to a constant factor (its linear and multiquadric kernels also carry
a minus sign), and a factor of the kernel changes the weights, never the interpolant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Kernel:
    """A radial kernel phi(r; c).

    Parameters
    ----------
    formula
        phi(r, c), with distance r and length c in parameters scaled to [0, 1].
    degree
        Degree of the polynomial that goes with it in `RBFInterpolator`: at least the degree that makes the
        interpolant unique (Fasshauer 2007, chapter 8), and at least a constant.
    scaled
        Whether c changes the interpolant.
    """

    formula: Callable[[np.ndarray, float], np.ndarray]
    degree: int
    scaled: bool


KERNELS = {
    "linear": Kernel(lambda r, c: r / c, 0, False),
    "cubic": Kernel(lambda r, c: (r / c) ** 3, 1, False),
    "multiquadric": Kernel(lambda r, c: np.sqrt(r**2 + c**2) / c, 0, True),
    "gaussian": Kernel(lambda r, c: np.exp(-((r / c) ** 2)), 0, True),
    "inverse_multiquadric": Kernel(lambda r, c: c / np.sqrt(r**2 + c**2), 0, True),
}
