"""Assembly of residual and tangent of the hexahedra, with the depth of the indenter as one bordered unknown.

Where a surface node is in contact, u_z = f(x + u_x, y + u_y) - depth is eliminated element by element: what is left of
its forces is balance along the indenter, F_i + f_i F_z = 0 without friction. The system stays symmetric. Friction needs
to know besides how its P = f_i F_i - F_z changes with the displacements, see `palpate.solver.pyramid.coupled`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.point import commit, history
from palpate.solver.pyramid import hencky_3d, linear_3d
from palpate.solver.pyramid.linear_3d import DISPLACEMENTS, Points3D
from palpate.solver.pyramid.mesh_3d import Mesh3D

DEPTH = DISPLACEMENTS  # the place of the depth, the twenty-fifth unknown of an element that touches the indenter
SLOPE_1, SLOPE_2, CURVATURE_11, CURVATURE_12, CURVATURE_22, GAP = range(6)


class Hexahedra(NamedTuple):
    """The mesh; see `palpate.solver.pyramid.mesh_3d.Mesh3D`, whose weights are the volumes."""

    elements: np.ndarray
    equations: np.ndarray
    turn: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray

    @classmethod
    def of(cls, mesh: Mesh3D) -> Hexahedra:
        """Return the arrays of a mesh."""
        return cls(mesh.elements, mesh.equations, mesh.turn, mesh.gradients, mesh.weights)


class Laws3D(NamedTuple):
    """Law of each element.

    Attributes
    ----------
    region : ndarray of int, shape (m,)
        Number of the law of each element.
    coefficients, weights : ndarray, shapes (regions, c) and (regions, w)
        The laws and their weights in the time step, see `palpate.materials.flow.row`.
    """

    region: np.ndarray
    coefficients: np.ndarray
    weights: np.ndarray


class Touching(NamedTuple):
    """Nodes in contact.

    Attributes
    ----------
    nodes : ndarray of bool, shape (n,)
        Whether a node is in contact.
    rule : ndarray, shape (n, 6)
        Slopes, curvatures and gap there, see `palpate.solver.pyramid.contact_3d.Contact3D`.
    slot : ndarray of int, shape (n,)
        Row of `System3D.pressing` that a surface node takes.
    """

    nodes: np.ndarray
    rule: np.ndarray
    slot: np.ndarray


class System3D(NamedTuple):
    """The assembled system, all output.

    Attributes
    ----------
    band : ndarray, shape (size, bandwidth + 1)
        ``band[j, i - j]`` holds the entry (i, j), i >= j.
    residual, border : ndarray, shape (size,)
        Internal forces, and derivative of the residual by the depth.
    force : ndarray, shape (n, 3)
        Force of the indenter on the nodes in contact, along the axes of each node.
    pressing : ndarray, shape (k, 2 bandwidth + 2) or (0, any)
        Derivatives of each P by the displacements, the one along z in the middle, and by the depth; none asked for
        without friction. The curvature of the indenter is not in them.
    pressure : ndarray, shape (m,)
        Of each element [GPa], positive in compression.
    """

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray
    force: np.ndarray
    pressing: np.ndarray
    pressure: np.ndarray


@njit(cache=True)
def assemble(displacement, mesh, laws, points, contact, system, large, geometric):
    """Assemble the constrained system, still without friction, at the given displacements.

    Parameters
    ----------
    displacement : ndarray, shape (n, 3)
        Along the axes of each node.
    mesh, laws, contact : Hexahedra, Laws3D, Touching
    points : Points3D
        Of all elements; solutions are written to it.
    system : System3D
        Out: the system.
    large : bool
        Logarithmic instead of linear strains.
    geometric : bool
        Whether the tangent contains the stiffness that stress gives by changing directions. Newton's method needs it;
        far from equilibrium it may make the system indefinite.

    Returns
    -------
    float
        Diagonal entry of the depth; NaN when an element is inside out.
    """
    elements, equations, turn, gradients, volumes = mesh
    region, coefficients, weights = laws
    past, back, alpha, guesses, local = points
    band, residual, border, force, pressing, pressure = system
    rule = contact.rule
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
        here = Points3D(past[e], back[e], alpha[e], guesses[e], local[e])
        law = weights[region[e]], coefficients[region[e]]
        if large:
            pressure[e] = hencky_3d.element(gradients[e], volumes[e], u, here, law, ke, fe, geometric)
            if np.isnan(pressure[e]):
                return np.nan
        else:
            pressure[e] = linear_3d.element(gradients[e], volumes[e], u, here, law, ke, fe)
        touching = False
        for a in range(8):
            node = elements[e, a]
            if turn[node, 1] != 0.0:
                _turn(ke, fe, 3 * a, turn[node, 0], turn[node, 1])
            touching |= contact.nodes[node]
        if touching:
            ke[DEPTH] = 0.0
            ke[:, DEPTH] = 0.0
            fe[DEPTH] = 0.0
            for a in range(8):
                node = elements[e, a]
                if contact.nodes[node] and rule[node, GAP] != 0.0:
                    for i in range(DEPTH):
                        fe[i] += ke[i, 3 * a + 2] * rule[node, GAP]
            if len(pressing) > 0:
                _press(ke, elements[e], equation, contact, rows, bandwidth, pressing)
            for a in range(8):
                node = elements[e, a]
                if contact.nodes[node]:
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


@inner_kernel(cache=True)
def _turn(ke, fe, x, cos, sin):
    """Turn one node's rows and columns from x and y to axes of its own."""
    y = x + 1
    fe[x], fe[y] = cos * fe[x] + sin * fe[y], cos * fe[y] - sin * fe[x]
    for i in range(DEPTH):
        ke[x, i], ke[y, i] = cos * ke[x, i] + sin * ke[y, i], cos * ke[y, i] - sin * ke[x, i]
    for i in range(DEPTH):
        ke[i, x], ke[i, y] = cos * ke[i, x] + sin * ke[i, y], cos * ke[i, y] - sin * ke[i, x]


@inner_kernel(cache=True)
def _press(ke, nodes, equation, contact, rows, bandwidth, pressing):
    """Add what an element's stiffness gives to the derivatives of P, with u_z = f - depth put in place of each u_z."""
    rule, slot = contact.rule, contact.slot
    for a in range(8):
        if contact.nodes[nodes[a]]:
            x, held = 3 * a, equation[3 * a + 1] < 0
            one, two = rule[nodes[a], SLOPE_1], 0.0 if held else rule[nodes[a], SLOPE_2]
            for i in range(DEPTH):
                rows[a, i] = one * ke[x, i] + two * ke[x + 1, i] - ke[x + 2, i]
            rows[a, DEPTH] = 0.0
            for b in range(8):
                if contact.nodes[nodes[b]]:
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


@inner_kernel(cache=True)
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
def begin_step(state, laws, points):
    """Write what the history `state` (m, 8, k) fixes at every Gauss point to the `points` of all elements."""
    region, coefficients, weights = laws
    for e in range(state.shape[0]):
        for g in range(8):
            law, past, back = coefficients[region[e]], points.past[e, g], points.back[e, g]
            points.alpha[e, g] = history(state[e, g], weights[region[e]], law, past, back)


@njit(cache=True)
def end_step(state, laws, points, pressure):
    """Advance `state` (m, 8, k) in place, with the solution at `points` and the `pressure` (m,) under `laws`."""
    region, coefficients, weights = laws
    for e in range(state.shape[0]):
        for g in range(8):
            law, back, alpha = coefficients[region[e]], points.back[e, g], points.alpha[e, g]
            q, r = points.guesses[e, g], points.local[e, g]
            commit(state[e, g], r, back, alpha, q, pressure[e], weights[region[e]], law)
