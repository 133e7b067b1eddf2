"""Assembly of residual and consistent tangent, with the depth of the indenter as one bordered unknown.

The volumetric strain of an element is the mean of tr E over it, against locking (B-bar; Simo, Taylor & Pister, Comput.
Methods Appl. Mech. Engrg. 51 (1985) 177-208). Where a surface node is in contact, its vertical displacement follows the
indenter, u_z = f(R) - depth at R = r + u_r, and is eliminated element by element: the system stays banded. What is left
of the node's forces (F_r, F_z) is balance along the generator with Coulomb friction, T = -m N,

    (1 + m f') F_r + (f' - m) F_z = 0,

where m, between -mu and mu, follows from how far the node has slipped (`palpate.fem.friction`). The system is symmetric
without friction only.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem import hencky, linear
from palpate.fem.contact import CURVATURE, GAP, RATIO, RATIO_SLOPE, SLOPE
from palpate.fem.scalar_radial import ALPHA, commit, history, invariant

DEPTH = 8  # the ninth unknown of an element that touches the indenter

_linear_element = linear.element
_hencky_element = hencky.element


@njit(cache=True)
def assemble(
    displacement, elements, equations, gradients, volumes, deviatoric, dilatation, region, coefficients, weights,
    past, alpha, guesses, local, large, geometric, contact, rule, band, diagonal, residual, border, force,
):  # fmt: skip
    """Assemble the constrained system at the given displacements.

    Parameters
    ----------
    displacement : ndarray, shape (n, 2)
    elements, equations, gradients, volumes
        See `palpate.fem.mesh.Mesh`.
    deviatoric, dilatation
        See `palpate.fem.linear.fixed_matrices`.
    region : ndarray of int, shape (m,)
        Row of `coefficients` and `weights` that each element takes.
    past, local : ndarray, shape (m, 4, 4)
        Strain fixed by the history at each Gauss point; out: the tensor R of the radial equation.
    alpha, guesses : ndarray, shape (m, 4)
        Accumulated plastic strain at the start of the step; last q, updated here.
    large : bool
        Logarithmic instead of linear strains.
    geometric : bool
        Keep the stiffness that stress gives to changing strain-displacement relations; without it the matrix is
        positive definite whatever the stress.
    contact : ndarray of bool, shape (n,)
        Nodes in contact.
    rule : ndarray, shape (n, 5)
        What holds at them, see `palpate.fem.contact.Contact`.
    band : ndarray, shape (size, columns)
        Out: ``band[j, diagonal + i - j]`` holds the entry (i, j); the lower half only where `diagonal` is zero.
    residual : ndarray, shape (size,)
        Out: internal forces.
    border : ndarray, shape (size, 2)
        Out: derivative of the residual by the depth, and of the load by the displacements.
    force : ndarray, shape (n, 2)
        Out: force of the indenter on the nodes in contact, along r and z.

    Returns
    -------
    float
        Diagonal entry of the depth; NaN when an element turned inside out.
    """
    band[:] = 0.0
    residual[:] = 0.0
    border[:] = 0.0
    force[:] = 0.0
    corner = 0.0
    ke = np.zeros((9, 9))
    fe = np.zeros(9)
    u = np.empty(8)
    equation = np.empty(8, dtype=np.int64)
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
            equation[a] = equations[elements[e, a // 2], a % 2]
        row, step = coefficients[region[e]], weights[region[e]]
        if large:
            if not _hencky_element(
                gradients[e], volumes[e], u, past[e], alpha[e], guesses[e], step, row, local[e], ke, fe, geometric
            ):
                return math.nan
        else:
            _linear_element(
                gradients[e], volumes[e], deviatoric[e], dilatation[e], u, past[e], alpha[e], guesses[e], step, row,
                local[e], ke, fe,
            )  # fmt: skip
        for a in range(4):
            node = elements[e, a]
            if contact[node] and rule[node, GAP] != 0.0:
                for i in range(8):
                    fe[i] += ke[i, 2 * a + 1] * rule[node, GAP]
        touching = False
        for a in range(4):
            node = elements[e, a]
            if contact[node]:
                if not touching:
                    touching = True
                    ke[DEPTH] = 0.0
                    ke[:, DEPTH] = 0.0
                    fe[DEPTH] = 0.0
                force[node, 0] += fe[2 * a]
                force[node, 1] += fe[2 * a + 1]
                _follow_indenter(ke, fe, 2 * a, rule[node])
        if touching:
            corner += ke[DEPTH, DEPTH]
        for a in range(8):
            i = equation[a]
            if i < 0:
                continue
            residual[i] += fe[a]
            if touching:
                border[i, 0] += ke[a, DEPTH]
                border[i, 1] += ke[DEPTH, a]
            for c in range(8):
                j = equation[c]
                if 0 <= j <= i or (diagonal > 0 and j >= 0):
                    band[j, diagonal + i - j] += ke[a, c]
    return corner


@njit(cache=True)
def _follow_indenter(ke, fe, r, rule):
    """Put u_z = f(R) - depth in place of one node's u_z, and balance along the generator in place of its forces.

    The element's ninth unknown is the depth, its ninth force the load.
    """
    z = r + 1
    slope, ratio = rule[SLOPE], rule[RATIO]
    radial, vertical = fe[r], fe[z]
    along, across = 1.0 + ratio * slope, slope - ratio
    stiffness = ke[z, z]
    for i in range(9):
        ke[r, i] = along * ke[r, i] + across * ke[z, i]
        ke[DEPTH, i] -= ke[z, i]
    for i in range(9):
        ke[i, r] += slope * ke[i, z]
        ke[i, DEPTH] -= ke[i, z]
    ke[r, r] += rule[CURVATURE] * (vertical + ratio * radial) + rule[RATIO_SLOPE] * (slope * radial - vertical)
    fe[r] = along * radial + across * vertical
    fe[DEPTH] -= vertical
    for i in range(9):
        ke[z, i] = 0.0
        ke[i, z] = 0.0
    ke[z, z] = stiffness
    fe[z] = 0.0


@njit(cache=True)
def begin_step(state, region, coefficients, weights, past, alpha):
    """Write what the history fixes at every Gauss point into `past` (m, 4, 4) and `alpha` (m, 4)."""
    for e in range(state.shape[0]):
        for g in range(4):
            history(state[e, g], weights[region[e]], coefficients[region[e]], past[e, g])
            alpha[e, g] = state[e, g, ALPHA]


@njit(cache=True)
def end_step(local, solution, region, coefficients, weights, state):
    """Advance `state` (m, 4, k) in place with the tensors R and invariants q of the converged step."""
    for e in range(state.shape[0]):
        for g in range(4):
            r = local[e, g]
            rho = invariant(r[0], r[1], r[2], r[3])
            commit(state[e, g], r, solution[e, g], rho, weights[region[e]], coefficients[region[e]])
