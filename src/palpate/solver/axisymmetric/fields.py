"""Stress in the body at one moment.

At small strains the deviator is a state variable, and the pressure follows from the mean dilatation of each element. At
large strains the state holds the law's stress T, turned to r and z. With the squared stretches l_a along the axes of
the right stretch, the divided differences f_ab of (1/2) ln l and the mean J of the element,

    S_ab = 2 f_ab T_ab,   sigma = (J / det F) F S F^T.

Source: Miehe, Apel & Lambrecht, Comput. Methods Appl. Mech. Engrg. 191 (2002) 5383-5425, section 3; for J see
`palpate.solver.axisymmetric.hencky`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.solver.axisymmetric.law_lanes import deviator
from palpate.solver.axisymmetric.mesh import Mesh

if TYPE_CHECKING:
    from palpate.solver.axisymmetric.march import States

COMPONENTS = ("rr", "zz", "tt", "rz")
PLANE = np.array([[0, 3], [3, 1]])  # of each entry of a tensor in r and z among the components
CLOSE = 1e-6  # relative distance of squared stretches below which their divided difference is its limit


@dataclass(frozen=True, eq=False)
class Moment:
    """A body at the end of a time step.

    Attributes
    ----------
    mesh : Mesh
        Lengths in um.
    large : bool
        Whether strains are.
    time, depth, load : float
        [s], [um], [mN]
    displacement : ndarray, shape (n, 2)
        [um]
    deviator : ndarray, shape (m, 4, 4)
        Deviator of the law's stress at the Gauss points: rr, zz, hoop, rz [GPa].
    pressure : ndarray, shape (m,)
        Of each element [GPa].
    """

    mesh: Mesh
    large: bool
    time: float
    depth: float
    load: float
    displacement: np.ndarray
    deviator: np.ndarray
    pressure: np.ndarray

    @classmethod
    def of(cls, mesh: Mesh, large: bool, states: States, time: float, unit: float) -> Moment:
        """Return the body of the first lane, whose unit of length is so many um.

        Parameters
        ----------
        mesh
            Mesh of the lane.
        large
            Whether strains are large.
        states
            The bodies at that time.
        time
            [s].
        unit
            Unit of length of the lane [um].
        """
        points, count = states.points, len(mesh.elements)
        displacement = states.displacement[mesh.equations, 0]  # those that are held share the last row, which is zero
        stress = deviator(points, states.weights, 0)
        return cls(
            replace(mesh, nodes=unit * mesh.nodes, gradients=mesh.gradients / unit, weights=unit**3 * mesh.weights),
            large,
            time,
            unit * float(states.depth[0]),
            unit**2 * float(states.reaction[0]),
            unit * displacement,
            stress.reshape(count, 4, 4),
            points.pressure[:, 0].copy(),
        )


@dataclass(frozen=True, eq=False)
class Fields:
    """Displacement and stress in a body.

    Attributes
    ----------
    mesh : Mesh or palpate.solver.pyramid.mesh_3d.Mesh3D
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
    def of(cls, moment: Moment) -> Fields:
        """Return the fields of a body of revolution; nodes touch that bear a contact pressure."""
        stress = cauchy_stress(moment)
        return cls(
            moment.mesh,
            moment.time,
            1e3 * moment.depth,
            moment.load,
            1e3 * moment.displacement,
            stress,
            touching(moment.mesh, stress),
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


def cauchy_stress(moment: Moment) -> np.ndarray:
    """Return the Cauchy stress (m, 4, 4) at the Gauss points: rr, zz, hoop, rz [GPa]."""
    gradient, hoop = displacement_gradient(moment.mesh, moment.displacement)
    stress = moment.deviator.copy()
    stress[..., :3] -= moment.pressure[:, None, None]
    if not moment.large:
        return stress
    deformation = np.eye(2) + gradient
    volume_ratio = np.linalg.det(deformation) * (1.0 + hoop)
    mean = np.average(np.log(volume_ratio), axis=1, weights=moment.mesh.weights)
    spread = volume_ratio / np.exp(mean)[:, None]
    plane = pushed_forward(stress[..., PLANE], deformation, spread)
    return np.stack([plane[..., 0, 0], plane[..., 1, 1], stress[..., 2] / spread, plane[..., 0, 1]], axis=-1)


def touching(mesh: Mesh, stress: np.ndarray) -> np.ndarray:
    """Return which nodes (n,) touch: on the surface, between elements pressed along z by a tenth of the hardest."""
    pressed = -stress[:, :, 1].mean(axis=1)
    found = np.zeros(len(mesh.nodes), dtype=bool)
    found[mesh.elements[pressed > 0.1 * pressed.max()]] = True
    surface = np.zeros_like(found)
    surface[mesh.surface] = True
    return found & surface


def displacement_gradient(mesh: Mesh, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return du_i/dX_j (m, 4, 2, 2) in r and z, and u_r / r (m, 4), at the Gauss points."""
    u = displacement[mesh.elements]
    gradient = np.einsum("eai,egja->egij", u, mesh.gradients[:, :, :2])
    return gradient, np.einsum("ea,ega->eg", u[:, :, 0], mesh.gradients[:, :, 2])


def pushed_forward(stress: np.ndarray, deformation: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Return the Cauchy stress of the law's `stress` (..., n, n), n = 2 or 3; `spread` (...,) is det F / J."""
    squared, axes = np.linalg.eigh(np.swapaxes(deformation, -1, -2) @ deformation)
    one, other = squared[..., :, None], squared[..., None, :]
    apart = np.abs(one - other) > CLOSE * one
    difference = np.where(apart, np.log(one / other) / np.where(apart, one - other, 1.0), 2.0 / (one + other))
    turned = np.swapaxes(axes, -1, -2) @ stress @ axes
    second = axes @ (difference * turned) @ np.swapaxes(axes, -1, -2)
    return deformation @ second @ np.swapaxes(deformation, -1, -2) / spread[..., None, None]
