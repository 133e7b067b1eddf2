"""Inner kernels of the solver, as functions that Python may call."""

from functools import cache

from numba import njit

from palpate.solver.axisymmetric import banded, contact, contact_coupling, coulomb_friction, tip
from palpate.solver.pyramid import hencky_3d, linear_3d


@cache
def from_python(kernel):
    """Return the function that compiles such a kernel with a caller of its own."""

    @njit
    def called(*arguments):
        return kernel(*arguments)

    return called


solve, solve_again = from_python(banded.solve), from_python(banded.solve_again)
contact_forces, fit, normal_distribution, penetration, width_of = map(
    from_python,
    (contact.contact_forces, contact.fit, contact.normal_distribution, contact.penetration, contact.width_of),
)
no_coupling, turn_back = from_python(contact_coupling.no_coupling), from_python(coulomb_friction.turn_back)
profile_at = from_python(tip.profile_at)
linear_hexahedron, hexahedron_at_large_strains = from_python(linear_3d.element), from_python(hencky_3d.element)
