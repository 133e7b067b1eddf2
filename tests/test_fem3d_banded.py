"""The banded solver of three dimensions against that of dense matrices."""

import numpy as np
import pytest

from palpate.solver.pyramid import banded_3d


@pytest.mark.parametrize("symmetric", [False, True])
def test_banded_solution_is_that_of_the_dense_system(symmetric):
    rng = np.random.default_rng(5)
    size, bandwidth = 12, 3
    near = np.abs(np.subtract.outer(np.arange(size), np.arange(size))) <= bandwidth
    matrix = np.where(near, rng.normal(size=(size, size)), 0.0) + 10.0 * np.eye(size)
    matrix = matrix + matrix.T if symmetric else matrix
    band = banded_3d.allocate(size, bandwidth, symmetric)
    band[:] = 0.0
    diagonal = banded_3d.diagonal(band, bandwidth)
    for i, j in zip(*np.nonzero(near), strict=True):
        if j <= i or not symmetric:
            band[j, diagonal + i - j] = matrix[i, j]
    right = rng.normal(size=(size, 2))
    assert banded_3d.solve(band.copy(), bandwidth, right, True) == pytest.approx(np.linalg.solve(matrix, right))
    assert banded_3d.solve(-band, bandwidth, right, True) is None
