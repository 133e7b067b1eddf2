"""Internal forces and stiffness of bodies at small or at large strains: compiled code holds one of them.

`Setup.large` is None at small strains and True at large ones. These are two types to numba, so that the choice is made
when the solver is compiled. Both together would take an eighth longer.
"""

from __future__ import annotations

from numba import types
from numba.extending import overload

from palpate.solver.axisymmetric import element, hencky

_small_forces, _small_stiffness = element.internal_forces, element.stiffness
_large_forces, _large_stiffness = hencky.internal_forces, hencky.stiffness


def internal_forces(setup, trial, forces):
    """Write the internal `forces`, see `palpate.solver.axisymmetric.element`; compiled code alone calls it."""
    raise NotImplementedError


def stiffness(setup, trial, geometric):
    """Write the tangent to the band, see `palpate.solver.axisymmetric.element`; compiled code alone calls it.

    Parameters
    ----------
    geometric : ndarray, shape (LANES,)
        Zero where it leaves out what keeps it from being positive definite.
    """
    raise NotImplementedError


@overload(internal_forces)
def _internal_forces(setup, trial, forces):
    """Return the function for the type of `large`."""

    def at_small_strains(setup, trial, forces):
        _small_forces(setup.body, trial.points, trial.laws, trial.weights, trial.displacement, forces)

    def at_large_strains(setup, trial, forces):
        _large_forces(setup.body, trial.points, trial.laws, trial.weights, trial.displacement, forces)

    return at_small_strains if _is_small(setup) else at_large_strains


@overload(stiffness)
def _stiffness(setup, trial, geometric):
    """Return the function for the type of `large`."""

    def at_small_strains(setup, trial, geometric):
        _small_stiffness(setup.body, trial.points, trial.laws, setup.system.band)

    def at_large_strains(setup, trial, geometric):
        _large_stiffness(setup.body, trial.points, trial.laws, trial.displacement, geometric, setup.system.band)

    return at_small_strains if _is_small(setup) else at_large_strains


def _is_small(setup: types.NamedTuple) -> bool:
    """Return whether a setup of this type is one at small strains."""
    return setup.types[setup.fields.index("large")] is types.none
