"""Stress in the wedge at one moment, as the axisymmetric `fields`, with six components along x, y and z.

The law's stress becomes Cauchy's as there.
"""

from __future__ import annotations

import numpy as np

from palpate.materials.flow.point import STRESS
from palpate.materials.flow.row import BULK
from palpate.solver.axisymmetric.fields import Fields, pushed_forward
from palpate.solver.pyramid.hencky_3d import PLACE
from palpate.solver.pyramid.linear_3d import COMPONENTS
from palpate.solver.pyramid.problem_3d import Problem3D, State

NAMES = ("xx", "yy", "zz", "xy", "yz", "zx")


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
    if not problem.large:
        return stress
    cauchy = pushed_forward(stress[..., PLACE], deformation, volume_ratio / np.exp(mean)[:, None])
    return cauchy[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
