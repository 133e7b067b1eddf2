"""Internal forces and stiffness of bodies at small or at large strains: compiled code holds one of them.

`Setup.large` is None at small strains and True at large ones. These are two types to numba, so that the choice is made
when the solver is compiled. Both together would take an eighth longer. For `setup` and `material` see
`palpate.solver.axisymmetric.trial_state`.
"""

from __future__ import annotations

from numba import types
from numba.extending import overload

from palpate.solver.axisymmetric import element, hencky

_small_forces, _small_stiffness = element.internal_forces, element.stiffness
_large_forces, _large_stiffness = hencky.internal_forces, hencky.stiffness


def internal_forces(setup, material, displacement, forces):
    """Write the internal `forces`, see `palpate.solver.axisymmetric.element`; compiled code alone calls it."""
    raise NotImplementedError


def stiffness(setup, material, displacement, geometric, band):
    """Write the tangent to the band, see `palpate.solver.axisymmetric.element`; compiled code alone calls it.

    Parameters
    ----------
    geometric : ndarray, shape (LANES,)
        Zero where it leaves out what keeps it from being positive definite.
    """
    raise NotImplementedError


@overload(internal_forces)
def _internal_forces(setup, material, displacement, forces):
    """Return the function for the type of `large`."""

    def at_small_strains(setup, material, displacement, forces):
        _small_forces(setup.body, material.points, material.laws, material.weights, displacement, forces)

    def at_large_strains(setup, material, displacement, forces):
        _large_forces(setup.body, material.points, material.laws, material.weights, displacement, forces)

    return at_small_strains if _is_small(setup) else at_large_strains


@overload(stiffness)
def _stiffness(setup, material, displacement, geometric, band):
    """Return the function for the type of `large`."""

    def at_small_strains(setup, material, displacement, geometric, band):
        _small_stiffness(setup.body, material.points, material.laws, material.weights, band)

    def at_large_strains(setup, material, displacement, geometric, band):
        _large_stiffness(setup.body, material.points, material.laws, material.weights, displacement, geometric, band)

    return at_small_strains if _is_small(setup) else at_large_strains


def _is_small(setup: types.NamedTuple) -> bool:
    """Return whether a setup of this type is one at small strains."""
    return setup.types[setup.fields.index("large")] is types.none
