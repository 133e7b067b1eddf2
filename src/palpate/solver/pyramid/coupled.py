"""Newton's direction with friction: a symmetric system, coupled through the few forces that press on the surface.

Friction adds c^n P_n to the balance along the indenter of each node n in contact
(`palpate.solver.pyramid.friction_3d`). Its derivative has two parts. That of c^n is symmetric and joins the stiffness
K. That of P_n = f_i F_i - F_z reaches all neighbours of the node and has no mirror image: with a column C_n that holds
c^n, and a row R_n = dP_n/d(u, depth),

    (K + C R) d = -r.

K keeps its Cholesky factor, and the changes p = R d of the pressing forces solve a system as small as the contact,

    (1 + R K^-1 C) p = -R K^-1 r,    d = -K^-1 (r + C p),

by GMRES (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856-869): C R is of the order of mu against K, so some ten
solutions with the factor are enough, at a fraction of the cost of an unsymmetric factorisation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.linear_system import Factored
from palpate.solver.pyramid.problem_3d import Workspace

ACCURACY = 1e-6  # relative, of GMRES: an error of the direction alone


@dataclass(frozen=True, eq=False)
class Coupling3D:
    """The unsymmetric part C R of the tangent, for t nodes in contact.

    Parameters
    ----------
    equations : ndarray of int, shape (t, 2)
        Of the two displacements along the indenter, -1 where held.
    ratio : ndarray, shape (t, 2)
        c, zero where held.
    window : ndarray of int, shape (t, 2 bandwidth + 2)
        Equations that the entries of a row belong to, counted from `bandwidth` before the first one; the depth's last.
    rows : ndarray, shape (t, 2 bandwidth + 2)
        R.
    size
        Number of equations.
    """

    equations: np.ndarray
    ratio: np.ndarray
    window: np.ndarray
    rows: np.ndarray
    size: int

    @classmethod
    def add(
        cls, contact: Contact3D, force: np.ndarray, pressing: np.ndarray, band: np.ndarray, residual: np.ndarray
    ) -> Coupling3D:
        """Add friction to the frictionless `residual` and `band`, and return what the band has no room for.

        Parameters
        ----------
        contact
            Where the indenter touches.
        band, residual
            The assembled system; in and out.
        force, pressing
            See `palpate.solver.pyramid.element_3d.assemble`.
        """
        mesh, surface = contact.mesh, contact.mesh.surface
        touching = np.flatnonzero(contact.touching[surface] & (mesh.equations[surface, 0] >= 0))
        nodes = surface[touching]
        equations, vertical = mesh.equations[nodes, :2], mesh.equations[nodes, 2]
        free = equations >= 0
        ratio, stiffness = (part[touching] for part in contact.friction.ratio(contact.slip, contact.slope))
        ratio *= free
        pressure = contact.pressure(force)[touching]
        stiffness *= np.maximum(pressure, 0.0)[:, None, None]
        residual[equations[free]] += (ratio * pressure[:, None])[free]
        rows, bandwidth = pressing[touching], mesh.bandwidth
        for i, j in ((0, 0), (0, 1), (1, 1)):
            here = free[:, i] & free[:, j]
            one, other = equations[here, i], equations[here, j]
            band[np.minimum(one, other), np.abs(one - other)] += stiffness[here, i, j]
        for i, bent in enumerate(_bent(contact, touching, force).T):
            here = free[:, i]
            rows[here, bandwidth + equations[here, i] - vertical[here]] += bent[here]
        window = np.append(np.arange(2 * bandwidth + 1), mesh.size + 2 * bandwidth)
        return cls(equations, ratio, window + vertical[:, None] * (window < mesh.size + 2 * bandwidth), rows, mesh.size)

    def pressed(self, change: np.ndarray) -> np.ndarray:
        """Return R d (t,), the changes of P by a `change` (size + 1,) of displacements and depth."""
        bandwidth = self.rows.shape[1] // 2 - 1
        margin = np.zeros(bandwidth)
        padded = np.concatenate([margin, change[:-1], margin, change[-1:]])
        return np.einsum("ti,ti->t", self.rows, padded[self.window])

    def forces(self, pressed: np.ndarray) -> np.ndarray:
        """Return C p (size + 1,), the friction of changes (t,) of P."""
        forces, free = np.zeros(self.size + 1), self.equations >= 0
        forces[self.equations[free]] = (self.ratio * pressed[:, None])[free]
        return forces


def _bent(contact: Contact3D, touching: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return what the indenter's curvature gives to dP/dx_i (t, 2), for some surface nodes (t,)."""
    nodes = contact.mesh.surface[touching]
    lateral = contact.mesh.equations[nodes, 1] >= 0
    held = 2.0 * (contact.hold[:, None] * contact.slope)[touching]
    one, two = force[nodes, 0] + held[:, 0], (force[nodes, 1] + held[:, 1]) * lateral
    first, mixed, second = contact.curvature[touching].T
    return np.stack([first * one + mixed * two, mixed * one + second * two], axis=1)


def coupled_direction(work: Workspace, coupling: Coupling3D, forces: np.ndarray, corner: float) -> np.ndarray | None:
    """Return the change (size + 1,) of displacements and depth that balances `forces` in the linearised system.

    None where the symmetric part is not positive definite or GMRES does not converge.

    Parameters
    ----------
    work
        The linear system.
    coupling
        Its unsymmetric part.
    forces : ndarray, shape (size + 1,)
        Residual of displacements and depth.
    corner
        Diagonal entry of the depth.
    """
    system = Factored.of(work, corner)
    if system is None or system.stiffness <= 0.0:
        return None

    def respond(pressed: np.ndarray) -> np.ndarray:
        return pressed + coupling.pressed(system.solve(coupling.forces(pressed)))

    alone, count = system.solve(-forces), len(coupling.rows)
    pressed, failed = gmres(LinearOperator((count, count), respond), coupling.pressed(alone), rtol=ACCURACY, restart=60)
    return None if failed else alone - system.solve(coupling.forces(pressed))
