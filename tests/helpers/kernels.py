"""Inner kernels of the solver, as functions that Python may call."""

from functools import cache

import numpy as np
from numba import njit

from palpate.solver.axisymmetric import banded, contact, contact_coupling, coulomb_friction, normal_lanes, tip
from palpate.solver.axisymmetric.lanes import LANES, splat, store
from palpate.solver.pyramid import hencky_3d, linear_3d


@cache
def from_python(kernel):
    """Return the function that compiles such a kernel with a caller of its own."""

    @njit
    def called(*arguments):
        return kernel(*arguments)

    return called


solve, solve_again = from_python(banded.solve), from_python(banded.solve_again)
contact_forces, fit = from_python(contact.contact_forces), from_python(contact.fit)
no_coupling, reverse_slip = from_python(contact_coupling.no_coupling), from_python(coulomb_friction.reverse_slip)
linear_hexahedron, hexahedron_at_large_strains = from_python(linear_3d.element), from_python(hencky_3d.element)


@njit
def in_lane(vectors, lane):
    """Return what the lane holds of each vector."""
    rows = np.empty((len(vectors), LANES))
    for i, vector in enumerate(vectors):
        store(rows, i, vector)
    return rows[:, lane]


@njit
def normal_distribution(x):
    """Return Phi and phi at a number."""
    return in_lane(normal_lanes.normal_distribution(splat(x)), 0)


@njit
def penetration(setup, trial, k, lane):
    """Return what the contact knows of a surface node in one lane."""
    return in_lane(contact.penetration(setup, trial, k), lane)


@njit
def width_of(setup_contact, state, k, lane):
    """Return the width over which the gap of a surface node closes in one lane."""
    return in_lane((contact.width_of(setup_contact, state, k),), lane)[0]


@njit
def profile_at(large, tips, lane, distance, moved):
    """Return height, slope and curvature of the tip of one lane."""
    return in_lane(tip.profile_at(large, tips, splat(distance), splat(moved)), lane)
