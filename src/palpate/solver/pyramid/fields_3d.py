"""Stress in the wedge at one moment, as the axisymmetric `fields`, with six components along x, y and z.

At large strains, with the squared stretches l_a along the axes of the right stretch and the divided differences f_ab of
(1/2) ln l (`palpate.solver.pyramid.hencky_3d`), the law's stress T gives S_ab = 2 f_ab T_ab and sigma = (J / det F) F S
F^T.
"""

from __future__ import annotations

import numpy as np

from palpate.materials.flow.point import STRESS
from palpate.materials.flow.row import BULK
from palpate.solver.axisymmetric.fields import Fields
from palpate.solver.pyramid.hencky_3d import PLACE
from palpate.solver.pyramid.linear_3d import COMPONENTS
from palpate.solver.pyramid.newton_3d import Problem3D, State

NAMES = ("xx", "yy", "zz", "xy", "yz", "zx")
CLOSE = 1e-6  # relative distance of squared stretches below which their divided difference is its limit


def fields_of(problem: Problem3D, state: State) -> Fields:
    """Return the fields of a `state`; displacements along x, y and z."""
    return Fields(
        problem.mesh,
        state.time,
        1e3 * state.depth,
        state.load,
        1e3 * along_xyz(problem, state),
        cauchy_stress(problem, state),
        state.contact,
        NAMES,
    )


def along_xyz(problem: Problem3D, state: State) -> np.ndarray:
    """Return displacements (n, 3) along x, y and z in place of the axes of each node [um]."""
    (cos, sin), (one, two, vertical) = problem.mesh.turn.T, state.displacement.T
    return np.stack([cos * one - sin * two, sin * one + cos * two, vertical], axis=1)


def cauchy_stress(problem: Problem3D, state: State) -> np.ndarray:
    """Return the Cauchy stress (m, 8, 6) at the Gauss points [GPa]."""
    mesh = problem.mesh
    gradient = np.einsum("eai,egaj->egij", along_xyz(problem, state)[mesh.elements], mesh.gradients)
    deformation = np.eye(3) + gradient
    volume_ratio = np.linalg.det(deformation)
    trace = np.log(volume_ratio) if problem.large else np.trace(gradient, axis1=2, axis2=3)
    mean = np.average(trace, axis=1, weights=mesh.weights)
    stress = state.material[..., STRESS : STRESS + COMPONENTS].copy()
    stress[..., :3] += (problem.coefficients[problem.region, BULK] * mean)[:, None, None]
    return _pushed(stress, deformation, volume_ratio / np.exp(mean)[:, None]) if problem.large else stress


def _pushed(conjugate: np.ndarray, deformation: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Return the Cauchy stress (..., 6) of the law's stress; `spread` is det F / J."""
    squared, axes = np.linalg.eigh(np.swapaxes(deformation, -1, -2) @ deformation)
    one, other = squared[..., :, None], squared[..., None, :]
    apart = np.abs(one - other) > CLOSE * one
    difference = np.where(apart, np.log(one / other) / np.where(apart, one - other, 1.0), 2.0 / (one + other))
    turned = np.swapaxes(axes, -1, -2) @ conjugate[..., PLACE] @ axes
    second = axes @ (difference * turned) @ np.swapaxes(axes, -1, -2)
    cauchy = deformation @ second @ np.swapaxes(deformation, -1, -2) / spread[..., None, None]
    rows, columns = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
    return cauchy[..., rows, columns]
