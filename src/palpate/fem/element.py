"""Assembly of residual and consistent tangent, with the depth of the indenter as one bordered unknown.

The volumetric strain of an element is the mean of tr E over it, against locking (B-bar; Simo, Taylor & Pister, Comput.
Methods Appl. Mech. Engrg. 51 (1985) 177-208). Where a surface node is in contact, its vertical displacement follows the
indenter, u_z = f(r + u_r) - depth, and is eliminated element by element: the system stays banded and symmetric.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem import hencky, linear
from palpate.materials.radial import ALPHA, commit, history, invariant

DEPTH = 8  # the ninth unknown of an element that touches the indenter

_linear_element = linear.element
_hencky_element = hencky.element


@njit(cache=True)
def assemble(
    displacement, elements, equations, gradients, volumes, deviatoric, dilatation, region, coefficients, weights,
    past, alpha, guesses, local, large, contact, slope, curvature, band, residual, border, reaction,
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
    contact : ndarray of bool, shape (n,)
        Nodes in contact; `slope` and `curvature` (n,) hold the indenter's profile there.
    band : ndarray, shape (size, bandwidth + 1)
        Out: lower band, ``band[j, i - j]`` holds the entry (i, j).
    residual, border : ndarray, shape (size,)
        Out: internal forces, and the column that couples the depth.
    reaction : ndarray, shape (n,)
        Out: vertical contact force at the nodes in contact.

    Returns
    -------
    float
        Diagonal entry of the depth; NaN when an element turned inside out.
    """
    band[:] = 0.0
    residual[:] = 0.0
    border[:] = 0.0
    reaction[:] = 0.0
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
                gradients[e], volumes[e], u, past[e], alpha[e], guesses[e], step, row, local[e], ke, fe
            ):
                return math.nan
        else:
            _linear_element(
                gradients[e], volumes[e], deviatoric[e], dilatation[e], u, past[e], alpha[e], guesses[e], step, row,
                local[e], ke, fe,
            )  # fmt: skip
        touching = False
        for a in range(4):
            node = elements[e, a]
            if contact[node]:
                if not touching:
                    touching = True
                    ke[DEPTH] = 0.0
                    ke[:, DEPTH] = 0.0
                    fe[DEPTH] = 0.0
                reaction[node] -= fe[2 * a + 1]
                _follow_indenter(ke, fe, 2 * a, slope[node], curvature[node])
        if touching:
            corner += ke[DEPTH, DEPTH]
        for a in range(8):
            i = equation[a]
            if i < 0:
                continue
            residual[i] += fe[a]
            if touching:
                border[i] += ke[a, DEPTH]
            for c in range(8):
                j = equation[c]
                if 0 <= j <= i:
                    band[j, i - j] += ke[a, c]
    return corner


@njit(cache=True)
def _follow_indenter(ke, fe, r, slope, curvature):
    """Put u_z = f(r + u_r) - depth in place of one node's u_z; the element's ninth unknown is the depth."""
    z = r + 1
    vertical = fe[z]
    diagonal = ke[z, z]
    for i in range(9):
        ke[r, i] += slope * ke[z, i]
        ke[DEPTH, i] -= ke[z, i]
    for i in range(9):
        ke[i, r] += slope * ke[i, z]
        ke[i, DEPTH] -= ke[i, z]
    ke[r, r] += curvature * vertical
    fe[r] += slope * vertical
    fe[DEPTH] -= vertical
    for i in range(9):
        ke[z, i] = 0.0
        ke[i, z] = 0.0
    ke[z, z] = diagonal
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
