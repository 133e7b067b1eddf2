"""Derivatives of every element's force and history by parameters, at the end of a converged step.

With the displacements held, the tensor R of the radial equation changes only by the strain that the history fixes:
that gives the right-hand sides (`carry`). With the derivatives of the displacements known, that of the history follows
for the next step (`settle`). The last axis of every derivative runs over the parameters.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from palpate.fem import hencky, linear
from palpate.fem.hencky import COS, SIN
from palpate.fem.scalar_radial import BULK
from palpate.fem.sensitivity_point import freeze, hold, move, powers_of

_linear_element = linear.element
_hencky_element = hencky.element
_strain_at = hencky.strain_at


@njit(cache=True, error_model="numpy")
def strain_matrices(e, gradients, u, large, b, trace):
    """Write dE/du at the Gauss points of an element in the fixed axes to `b` (4, 4, 8), and tr E to `trace` (4,).

    At small strains the zeros of `b` stay as they are.
    """
    if large:
        strain, frame = np.empty(3), np.empty(7)
    for g in range(4):
        if large:
            _strain_at(gradients[e, g], u, strain, b[g], frame)
            trace[g] = strain[0] + strain[1] + strain[2]
            c, s = frame[COS], frame[SIN]
            for i in range(8):
                b0, b1, b3 = b[g, 0, i], b[g, 1, i], b[g, 3, i]
                b[g, 0, i] = b0 * c * c + b1 * s * s - 2.0 * b3 * s * c
                b[g, 1, i] = b0 * s * s + b1 * c * c + 2.0 * b3 * s * c
                b[g, 3, i] = (b0 - b1) * s * c + b3 * (c * c - s * s)
        else:
            trace[g] = 0.0
            for a in range(4):
                nr, nz, nt = gradients[e, g, 0, a], gradients[e, g, 1, a], gradients[e, g, 2, a]
                b[g, 0, 2 * a], b[g, 1, 2 * a + 1], b[g, 2, 2 * a] = nr, nz, nt
                b[g, 3, 2 * a], b[g, 3, 2 * a + 1] = 0.5 * nz, 0.5 * nr
                trace[g] += (nr + nt) * u[2 * a] + nz * u[2 * a + 1]


@njit(cache=True, error_model="numpy")
def carry(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    state, alphas, local, solution, powers, change, d_force,
):  # fmt: skip
    """Carry the derivative of the history into the step and add that of the nodal forces at fixed displacements.

    Parameters
    ----------
    elements, gradients, volumes
        See `palpate.fem.mesh.Mesh`.
    large : bool
    displacement : ndarray, shape (n, 2)
        At the end of the step.
    region, coefficients, weights
        Laws and what the step makes of them, see `palpate.fem.element.assemble`.
    d_coefficients, d_weights : ndarray, shapes (regions, c, p) and (regions, w, p)
    state, alphas, local, solution : ndarray, shapes (m, 4, s), (m, 4), (m, 4, 4) and (m, 4)
        State and its accumulated plastic strain at the start of the step; R and q at its end.
    powers : ndarray, shape (m, 4, elements + 2)
        log q and all q^(2 m) at the start of the step; afterwards, at its end.
    change : ndarray, shape (m, 4, s, p)
        Derivative of `state`; afterwards, of what it fixes in the step.
    d_force : ndarray, shape (n, 2, p)
        Receives the derivative of the internal forces.
    """
    count = change.shape[3]
    b, trace, u, fe = np.zeros((4, 4, 8)), np.empty(4), np.empty(8), np.empty((8, count))
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
        strain_matrices(e, gradients, u, large, b, trace)
        volume, dilatation = 0.0, 0.0
        for g in range(4):
            volume += volumes[e, g]
            dilatation += volumes[e, g] * trace[g]
        expansion = math.exp(dilatation / volume) if large else 1.0
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        for a in range(8):
            swelling = 0.0
            for g in range(4):
                swelling += volumes[e, g] * (b[g, 0, a] + b[g, 1, a] + b[g, 2, a])
            for j in range(count):
                fe[a, j] = dilatation / volume * swelling * d_row[BULK, j]
        for g in range(4):
            freeze(e, g, state, change, row, d_row, step, d_step, powers)
            powers_of(e, g, solution[e, g], row, step, powers)
            hold(e, g, change, local, solution, alphas, row, d_row, step, d_step, powers)
            for j in range(count):
                weight = volumes[e, g]
                s0, s1 = weight * change[e, g, 0, j], weight * change[e, g, 1, j]
                s2, s3 = weight * change[e, g, 2, j], 2.0 * weight * change[e, g, 3, j]
                for a in range(8):
                    fe[a, j] += b[g, 0, a] * s0 + b[g, 1, a] * s1 + b[g, 2, a] * s2 + b[g, 3, a] * s3
        for a in range(8):
            for j in range(count):
                d_force[elements[e, a // 2], a % 2, j] += expansion * fe[a, j]


@njit(cache=True, error_model="numpy")
def settle(
    elements, gradients, volumes, large, displacement, region, coefficients, d_coefficients, weights, d_weights,
    alphas, local, solution, powers, d_displacement, change,
):  # fmt: skip
    """Turn `change`, as `carry` left it, into the derivative of the state at the end of the step.

    Parameters
    ----------
    d_displacement : ndarray, shape (n, 2, p)
        Derivative of the displacements at the end of the step.
    """
    count = change.shape[3]
    b, trace, u = np.zeros((4, 4, 8)), np.empty(4), np.empty(8)
    d_u, d_strain = np.empty((8, count)), np.empty((4, count))
    for e in range(elements.shape[0]):
        for a in range(8):
            u[a] = displacement[elements[e, a // 2], a % 2]
            for j in range(count):
                d_u[a, j] = d_displacement[elements[e, a // 2], a % 2, j]
        strain_matrices(e, gradients, u, large, b, trace)
        k = region[e]
        row, d_row, step, d_step = coefficients[k], d_coefficients[k], weights[k], d_weights[k]
        for g in range(4):
            for j in range(count):
                d0, d1, d2, d3 = 0.0, 0.0, 0.0, 0.0
                for a in range(8):
                    d0 += b[g, 0, a] * d_u[a, j]
                    d1 += b[g, 1, a] * d_u[a, j]
                    d2 += b[g, 2, a] * d_u[a, j]
                    d3 += b[g, 3, a] * d_u[a, j]
                d_strain[0, j], d_strain[1, j], d_strain[2, j], d_strain[3, j] = d0, d1, d2, d3
            move(e, g, change, d_strain, local, solution, alphas, row, d_row, step, d_step, powers)


@njit(cache=True, error_model="numpy")
def push(
    elements, gradients, volumes, large, displacement, region, coefficients, weights, past, alpha, deviatoric,
    dilatation, guesses, pushed, lift, d_force,
):  # fmt: skip
    """Add the change (n, 2, p) of the internal forces where the nodes `pushed` (n,) move along z by `lift` (n, p)."""
    ke, fe, u, local, q = np.zeros((9, 9)), np.zeros(9), np.empty(8), np.empty((4, 4)), np.empty(4)
    for e in range(elements.shape[0]):
        corners = elements[e]
        if not (pushed[corners[0]] or pushed[corners[1]] or pushed[corners[2]] or pushed[corners[3]]):
            continue
        for a in range(8):
            u[a] = displacement[corners[a // 2], a % 2]
        q[:] = guesses[e]
        row, step = coefficients[region[e]], weights[region[e]]
        if large:
            _hencky_element(gradients[e], volumes[e], u, past[e], alpha[e], q, step, row, local, ke, fe)
        else:
            _linear_element(
                gradients[e], volumes[e], deviatoric[e], dilatation[e], u, past[e], alpha[e], q, step, row, local,
                ke, fe,
            )  # fmt: skip
        for c in range(4):
            if pushed[corners[c]]:
                for a in range(8):
                    for j in range(lift.shape[1]):
                        d_force[corners[a // 2], a % 2, j] += ke[a, 2 * c + 1] * lift[corners[c], j]
