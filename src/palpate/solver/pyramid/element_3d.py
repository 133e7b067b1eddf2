"""Assembly of residual and tangent of the hexahedra, with the depth of the indenter as one bordered unknown.

Where a surface node is in contact, u_z = f(x + u_x, y + u_y) - depth is eliminated element by element: what is left of
its forces is balance along the indenter, F_i + f_i F_z = 0 without friction. The system stays symmetric. Friction needs
to know besides how its P = f_i F_i - F_z changes with the displacements, see `palpate.solver.pyramid.coupled`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from palpate.materials.flow.point import commit, history
from palpate.solver.pyramid import hencky_3d, linear_3d
from palpate.solver.pyramid.linear_3d import COMPONENTS, DISPLACEMENTS

DEPTH = DISPLACEMENTS  # the place of the depth, the twenty-fifth unknown of an element that touches the indenter
SLOPE_1, SLOPE_2, CURVATURE_11, CURVATURE_12, CURVATURE_22, GAP = range(6)


@njit(cache=True)
def assemble(
    displacement, elements, equations, turn, gradients, volumes, region, coefficients, weights, past, alpha, guesses,
    pressure, local, large, geometric, contact, rule, slot, band, residual, border, force, pressing,
):  # fmt: skip
    """Assemble the constrained system, still without friction, at the given displacements.

    Parameters
    ----------
    displacement : ndarray, shape (n, 3)
        Along the axes of each node.
    elements, equations, turn, gradients, volumes
        See `palpate.solver.pyramid.mesh_3d.Mesh3D`.
    region : ndarray of int, shape (m,)
        The law of each element.
    coefficients, weights : ndarray, shapes (regions, c) and (regions, w)
        The laws and what the time step makes of them, see `palpate.materials.flow.row`.
    past, local : ndarray, shape (m, 8, 6)
        Strain fixed by the history at each Gauss point; out: the tensor R of the radial equation.
    alpha, guesses : ndarray, shape (m, 8)
        Accumulated plastic strain at the start of the step; last q, updated here.
    pressure : ndarray, shape (m,)
        Out: of each element [GPa], positive in compression.
    large : bool
        Logarithmic instead of linear strains.
    geometric : bool
        Whether the tangent contains the stiffness that stress gives by changing directions. Newton's method needs it;
        far from equilibrium it may make the system indefinite.
    contact : ndarray of bool, shape (n,)
        Nodes in contact.
    rule : ndarray, shape (n, 6)
        Slopes, curvatures and gap there, see `palpate.solver.pyramid.contact_3d.Contact3D`.
    slot : ndarray of int, shape (n,)
        Row of `pressing` that a surface node takes.
    band : ndarray, shape (size, bandwidth + 1)
        Out: ``band[j, i - j]`` holds the entry (i, j), i >= j.
    residual : ndarray, shape (size,)
        Out: internal forces.
    border : ndarray, shape (size,)
        Out: derivative of the residual by the depth.
    force : ndarray, shape (n, 3)
        Out: force of the indenter on the nodes in contact, along the axes of each node.
    pressing : ndarray, shape (k, 2 bandwidth + 2) or (0, any)
        Out: derivatives of each P by the displacements, the one along z in the middle, and by the depth; none asked for
        without friction. The curvature of the indenter is not in them.

    Returns
    -------
    float
        Diagonal entry of the depth; NaN when an element is inside out.
    """
    band[:] = 0.0
    residual[:] = 0.0
    border[:] = 0.0
    force[:] = 0.0
    pressing[:] = 0.0
    corner, bandwidth = 0.0, band.shape[1] - 1
    ke = np.zeros((DEPTH + 1, DEPTH + 1))
    fe = np.zeros(DEPTH + 1)
    u = np.empty((8, 3))
    rows = np.zeros((8, DEPTH + 1))
    equation = np.empty(DEPTH, dtype=np.int64)
    for e in range(elements.shape[0]):
        for a in range(8):
            node = elements[e, a]
            cos, sin = turn[node, 0], turn[node, 1]
            u[a, 0] = cos * displacement[node, 0] - sin * displacement[node, 1]
            u[a, 1] = sin * displacement[node, 0] + cos * displacement[node, 1]
            u[a, 2] = displacement[node, 2]
            equation[3 * a : 3 * a + 3] = equations[node]
        points = past[e], alpha[e], guesses[e], weights[region[e]], coefficients[region[e]], local[e]
        if large:
            pressure[e] = hencky_3d.element(gradients[e], volumes[e], u, *points, ke, fe, geometric)
            if np.isnan(pressure[e]):
                return np.nan
        else:
            pressure[e] = linear_3d.element(gradients[e], volumes[e], u, *points, ke, fe)
        touching = False
        for a in range(8):
            node = elements[e, a]
            if turn[node, 1] != 0.0:
                _turn(ke, fe, 3 * a, turn[node, 0], turn[node, 1])
            touching |= contact[node]
        if touching:
            ke[DEPTH] = 0.0
            ke[:, DEPTH] = 0.0
            fe[DEPTH] = 0.0
            for a in range(8):
                node = elements[e, a]
                if contact[node] and rule[node, GAP] != 0.0:
                    for i in range(DEPTH):
                        fe[i] += ke[i, 3 * a + 2] * rule[node, GAP]
            if len(pressing) > 0:
                _press(ke, elements[e], equation, contact, rule, slot, rows, bandwidth, pressing)
            for a in range(8):
                node = elements[e, a]
                if contact[node]:
                    for i in range(3):
                        force[node, i] += fe[3 * a + i]
                    _follow_indenter(ke, fe, 3 * a, rule[node])
            corner += ke[DEPTH, DEPTH]
        for a in range(DEPTH):
            i = equation[a]
            if i < 0:
                continue
            residual[i] += fe[a]
            if touching:
                border[i] += ke[a, DEPTH]
            for c in range(DEPTH):
                j = equation[c]
                if 0 <= j <= i:
                    band[j, i - j] += ke[a, c]
    return corner


@njit(cache=True)
def _turn(ke, fe, x, cos, sin):
    """Turn one node's rows and columns from x and y to axes of its own."""
    y = x + 1
    fe[x], fe[y] = cos * fe[x] + sin * fe[y], cos * fe[y] - sin * fe[x]
    for i in range(DEPTH):
        ke[x, i], ke[y, i] = cos * ke[x, i] + sin * ke[y, i], cos * ke[y, i] - sin * ke[x, i]
    for i in range(DEPTH):
        ke[i, x], ke[i, y] = cos * ke[i, x] + sin * ke[i, y], cos * ke[i, y] - sin * ke[i, x]


@njit(cache=True)
def _press(ke, nodes, equation, contact, rule, slot, rows, bandwidth, pressing):
    """Add what an element's stiffness gives to the derivatives of P, with u_z = f - depth put in place of each u_z."""
    for a in range(8):
        if contact[nodes[a]]:
            x, held = 3 * a, equation[3 * a + 1] < 0
            one, two = rule[nodes[a], SLOPE_1], 0.0 if held else rule[nodes[a], SLOPE_2]
            for i in range(DEPTH):
                rows[a, i] = one * ke[x, i] + two * ke[x + 1, i] - ke[x + 2, i]
            rows[a, DEPTH] = 0.0
            for b in range(8):
                if contact[nodes[b]]:
                    y, z = 3 * b + 1, 3 * b + 2
                    rows[a, y - 1] += rule[nodes[b], SLOPE_1] * rows[a, z]
                    rows[a, y] += rule[nodes[b], SLOPE_2] * rows[a, z]
                    rows[a, DEPTH] -= rows[a, z]
                    rows[a, z] = 0.0
            row, middle = pressing[slot[nodes[a]]], bandwidth - equation[x + 2]
            for i in range(DEPTH):
                if equation[i] >= 0:
                    row[middle + equation[i]] += rows[a, i]
            row[2 * bandwidth + 1] += rows[a, DEPTH]


@njit(cache=True)
def _follow_indenter(ke, fe, x, rule):
    """Put u_z = f - depth in place of one node's u_z, and balance along the indenter in place of its forces.

    The element's last unknown is the depth, its last force the load.
    """
    y, z = x + 1, x + 2
    vertical, stiffness = fe[z], ke[z, z]
    for i in range(DEPTH + 1):
        ke[x, i] += rule[SLOPE_1] * ke[z, i]
        ke[y, i] += rule[SLOPE_2] * ke[z, i]
        ke[DEPTH, i] -= ke[z, i]
    for i in range(DEPTH + 1):
        ke[i, x] += rule[SLOPE_1] * ke[i, z]
        ke[i, y] += rule[SLOPE_2] * ke[i, z]
        ke[i, DEPTH] -= ke[i, z]
    ke[x, x] += rule[CURVATURE_11] * vertical
    ke[x, y] += rule[CURVATURE_12] * vertical
    ke[y, x] += rule[CURVATURE_12] * vertical
    ke[y, y] += rule[CURVATURE_22] * vertical
    fe[x] += rule[SLOPE_1] * vertical
    fe[y] += rule[SLOPE_2] * vertical
    fe[DEPTH] -= vertical
    for i in range(DEPTH + 1):
        ke[z, i] = 0.0
        ke[i, z] = 0.0
    ke[z, z] = stiffness
    fe[z] = 0.0


@njit(cache=True)
def begin_step(state, region, coefficients, weights, past, alpha):
    """Write what the history fixes at every Gauss point into `past` (m, 8, 6) and `alpha` (m, 8).

    Arguments are those of `assemble`; `state` (m, 8, k) holds the state variables.
    """
    for e in range(state.shape[0]):
        for g in range(8):
            history(state[e, g], weights[region[e]], coefficients[region[e]], past[e, g])
            alpha[e, g] = state[e, g, 2 * COMPONENTS]


@njit(cache=True)
def end_step(local, solution, pressure, region, coefficients, weights, state):
    """Advance `state` (m, 8, k) in place with the tensors R, invariants q and pressures of the converged step.

    Arguments are those of `assemble`; `solution` (m, 8) holds q [GPa].
    """
    for e in range(state.shape[0]):
        for g in range(8):
            law = coefficients[region[e]]
            commit(state[e, g], local[e, g], solution[e, g], pressure[e], weights[region[e]], law)
