"""Stress in the body at one moment.

At small strains the deviator is a state variable, and the pressure follows from the mean dilatation of each element. At
large strains the state holds the law's stress T, turned to r and z. With the squared stretches l_a along the axes of
the right stretch, d = (ln l_1 - ln l_2) / (2 (l_1 - l_2)) and the mean J of the element,

    S_aa = T_aa / l_a,   S_12 = 2 d T_12,   sigma = (J / det F) F S F^T.

Source: Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425, section 3; for J see
`palpate.fem.hencky`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.fem.mesh import Mesh
from palpate.fem.newton import Problem, State
from palpate.fem.scalar_radial import BULK, STRESS

COMPONENTS = ("rr", "zz", "tt", "rz")


@dataclass(frozen=True, eq=False)
class Fields:
    """Displacement and stress in a body.

    Attributes
    ----------
    mesh : Mesh or palpate.fem3d.mesh.Mesh
    time, depth, load : float
        [s], [nm], [mN]
    displacement : ndarray, shape (n, 2) or (n, 3)
        Of the nodes, along r and z or x, y and z [nm].
    stress : ndarray, shape (m, g, c)
        Cauchy stress at the Gauss points of each element: three normal components, then those of shear [GPa].
    touching : ndarray of bool, shape (n,)
        Nodes in contact.
    components
        Names of the components of stress.
    """

    mesh: Any
    time: float
    depth: float
    load: float
    displacement: np.ndarray
    stress: np.ndarray
    touching: np.ndarray
    components: tuple[str, ...] = COMPONENTS

    @classmethod
    def of(cls, problem: Problem, state: State) -> Fields:
        """Return the fields of a `state`."""
        return cls(
            problem.mesh,
            state.time,
            1e3 * state.depth,
            -float(state.force[:, 1].sum()),
            1e3 * state.displacement,
            cauchy_stress(problem, state),
            state.contact,
        )

    @property
    def element_stress(self) -> np.ndarray:
        """Mean stress of each element by volume (m, c) [GPa]."""
        weights = self.mesh.weights
        return np.einsum("eg,egi->ei", weights, self.stress) / weights.sum(axis=1)[:, None]

    @property
    def element_von_mises(self) -> np.ndarray:
        """Mean von Mises stress of each element by volume (m,) [GPa]."""
        return np.average(von_mises(self.stress), axis=1, weights=self.mesh.weights)


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Return sqrt(3/2 s:s) of stresses (..., c), three normal components before those of shear [GPa]."""
    deviator = stress.copy()
    deviator[..., :3] -= stress[..., :3].mean(axis=-1, keepdims=True)
    return np.sqrt(1.5 * (deviator[..., :3] ** 2).sum(axis=-1) + 3.0 * (deviator[..., 3:] ** 2).sum(axis=-1))


def cauchy_stress(problem: Problem, state: State) -> np.ndarray:
    """Return the Cauchy stress (m, 4, 4) at the Gauss points: rr, zz, hoop, rz [GPa]."""
    mesh = problem.mesh
    gradient, hoop = displacement_gradient(mesh, state.displacement)
    dilatation = np.trace(gradient, axis1=2, axis2=3) + hoop
    deformation = np.eye(2) + gradient
    volume_ratio = np.linalg.det(deformation) * (1.0 + hoop)
    trace = np.log(volume_ratio) if problem.large else dilatation
    mean = np.average(trace, axis=1, weights=mesh.weights)
    pressure = problem.coefficients[problem.region, BULK] * mean
    stress = state.material[..., STRESS : STRESS + 4].copy()
    stress[..., :3] += pressure[:, None, None]
    return _pushed(stress, deformation, volume_ratio / np.exp(mean)[:, None]) if problem.large else stress


def displacement_gradient(mesh: Mesh, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return du_i/dX_j (m, 4, 2, 2) in r and z, and u_r / r (m, 4), at the Gauss points."""
    u = displacement[mesh.elements]
    gradient = np.einsum("eai,egja->egij", u, mesh.gradients[:, :, :2])
    return gradient, np.einsum("ea,ega->eg", u[:, :, 0], mesh.gradients[:, :, 2])


def _pushed(conjugate: np.ndarray, deformation: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Return the Cauchy stress (..., 4) of the law's stress, given as rr, zz, hoop, rz; `spread` is det F / J."""
    squared, axes = np.linalg.eigh(np.swapaxes(deformation, -1, -2) @ deformation)
    plane = conjugate[..., [0, 3, 3, 1]].reshape(*conjugate.shape[:-1], 2, 2)
    one, two = squared[..., 0], squared[..., 1]
    apart = np.abs(two - one) > 1e-6 * one
    difference = np.where(apart, np.log(two / one) / np.where(apart, 2.0 * (two - one), 1.0), 1.0 / (one + two))
    scale = np.empty_like(plane)
    scale[..., 0, 0], scale[..., 1, 1] = 1.0 / one, 1.0 / two
    scale[..., 0, 1] = scale[..., 1, 0] = 2.0 * difference
    turned = np.swapaxes(axes, -1, -2) @ plane @ axes
    second = axes @ (scale * turned) @ np.swapaxes(axes, -1, -2)
    cauchy = deformation @ second @ np.swapaxes(deformation, -1, -2) / spread[..., None, None]
    return np.stack([cauchy[..., 0, 0], cauchy[..., 1, 1], conjugate[..., 2] / spread, cauchy[..., 0, 1]], axis=-1)
