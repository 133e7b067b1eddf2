"""Internal forces and stiffness of bodies at small or at large strains: compiled code holds one of them.

`large` is None at small strains and True at large ones. These are two types to numba, so that the choice is made when
the solver is compiled. Both together would take an eighth longer.
"""

from __future__ import annotations

from numba import types
from numba.extending import overload

from palpate.solver.axisymmetric import element, hencky

_small_forces, _small_stiffness = element.internal_forces, element.stiffness
_large_forces, _large_stiffness = hencky.internal_forces, hencky.stiffness


def internal_forces(large, body, points, laws, weights, displacement, forces):
    """Write the internal `forces`, see `palpate.solver.axisymmetric.element`; compiled code alone calls it."""
    raise NotImplementedError


def stiffness(large, body, points, laws, displacement, geometric, band):
    """Write the tangent to the `band`, see `palpate.solver.axisymmetric.element`; compiled code alone calls it.

    Parameters
    ----------
    geometric : ndarray, shape (LANES,)
        Zero where it leaves out what keeps it from being positive definite.
    """
    raise NotImplementedError


@overload(internal_forces)
def _internal_forces(large, body, points, laws, weights, displacement, forces):
    """Return the function for the type of `large`."""

    def at_small_strains(large, body, points, laws, weights, displacement, forces):
        _small_forces(body, points, laws, weights, displacement, forces)

    def at_large_strains(large, body, points, laws, weights, displacement, forces):
        _large_forces(body, points, laws, weights, displacement, forces)

    return at_small_strains if large is types.none else at_large_strains


@overload(stiffness)
def _stiffness(large, body, points, laws, displacement, geometric, band):
    """Return the function for the type of `large`."""

    def at_small_strains(large, body, points, laws, displacement, geometric, band):
        _small_stiffness(body, points, laws, band)

    def at_large_strains(large, body, points, laws, displacement, geometric, band):
        _large_stiffness(body, points, laws, displacement, geometric, band)

    return at_small_strains if large is types.none else at_large_strains
