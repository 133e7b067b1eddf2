"""What a simulation in three dimensions works on: the problem, the state that steps hand on, and storage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.materials.flow.point import state_size
from palpate.solver.axisymmetric.adhesive_traction import Adhesion
from palpate.solver.axisymmetric.regions import laws_of
from palpate.solver.pyramid.linear_3d import COMPONENTS
from palpate.solver.pyramid.mesh_3d import Mesh3D
from palpate.solver.pyramid.tip_3d import Tip
from palpate.study.specimen import Specimen

WEDGES = 6.0  # of the body, which share the load


@dataclass(frozen=True, eq=False)
class Problem3D:
    """What does not change during a simulation.

    Parameters
    ----------
    mesh : Mesh3D
    tip : Tip
    specimen : Specimen
    coefficients : ndarray, shape (regions, c)
        Law of each region, see `palpate.materials.flow.row`.
    region : ndarray of int, shape (m,)
        Region of each element.
    friction : float
        Coulomb coefficient between indenter and body.
    large : bool
        Logarithmic instead of linear strains.
    adhesion
        Attraction between them.
    """

    mesh: Mesh3D
    tip: Tip
    specimen: Specimen
    coefficients: np.ndarray
    region: np.ndarray
    friction: float = 0.0
    large: bool = False
    adhesion: Adhesion | None = None

    @classmethod
    def of(
        cls,
        mesh: Mesh3D,
        tip: Tip,
        specimen: Specimen,
        friction: float = 0.0,
        large: bool = False,
        adhesion: Adhesion | None = None,
    ) -> Problem3D:
        """Divide the specimen into its regions.

        Arguments are those of `Problem3D`.
        """
        laws, elements = laws_of(specimen, mesh), np.arange(len(mesh.elements))
        region = elements if len(laws) > 1 else np.zeros_like(elements)
        return cls(mesh, tip, specimen, laws, region, friction, large, adhesion)

    @property
    def hold(self) -> np.ndarray:
        """Force along z (k,) [mN] by which adhesion holds each surface node."""
        return np.zeros(len(self.mesh.surface)) if self.adhesion is None else self.adhesion.hold


@dataclass(frozen=True, eq=False)
class State:
    """Everything that a step hands to the next one.

    Attributes
    ----------
    time, depth : float
        [s], [um]
    displacement : ndarray, shape (n, 3)
        Along the axes of each node [um].
    material : ndarray, shape (m, 8, s)
        State variables at the Gauss points.
    contact : ndarray of bool, shape (n,)
    guesses : ndarray, shape (m, 8)
        Last q at each Gauss point, where the next search begins.
    force : ndarray, shape (n, 3)
        Force of the indenter on the nodes of the wedge, along the axes of each node [mN].
    anchor : ndarray, shape (k, 2)
        Where each surface node sticks, see `palpate.solver.pyramid.contact_3d.Contact3D` [um]; NaN where it does not
        touch.
    """

    time: float
    depth: float
    displacement: np.ndarray
    material: np.ndarray
    contact: np.ndarray
    guesses: np.ndarray
    force: np.ndarray
    anchor: np.ndarray

    @property
    def load(self) -> float:
        """What the indenter presses with [mN], on the whole body."""
        return -WEDGES * float(self.force[:, 2].sum())

    @classmethod
    def initial(cls, problem: Problem3D) -> State:
        """Return the unloaded body that the apex just touches."""
        n, m = len(problem.mesh.nodes), len(problem.mesh.elements)
        material = np.zeros((m, 8, state_size(problem.coefficients[0], COMPONENTS)))
        anchor = np.full((len(problem.mesh.surface), 2), np.nan)
        guesses, still = np.zeros((m, 8)), np.zeros((n, 3))
        return cls(0.0, 0.0, still, material, np.arange(n) == 0, guesses, np.zeros((n, 3)), anchor)


@dataclass
class Workspace:
    """Arrays of the linear system, allocated once a simulation; see `palpate.solver.pyramid.element_3d`."""

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray
    past: np.ndarray
    back: np.ndarray
    alpha: np.ndarray
    pressure: np.ndarray
    local: np.ndarray
    slot: np.ndarray
    pressing: np.ndarray

    @classmethod
    def of(cls, problem: Problem3D) -> Workspace:
        """Allocate for `problem`."""
        mesh = problem.mesh
        m, k = len(mesh.elements), len(mesh.surface)
        slot = np.full(len(mesh.nodes), -1)
        slot[mesh.surface] = np.arange(k)
        return cls(
            np.empty((mesh.size, mesh.bandwidth + 1)),
            np.empty(mesh.size),
            np.empty(mesh.size),
            np.empty((m, 8, COMPONENTS)),
            np.empty((m, 8, COMPONENTS)),
            np.empty((m, 8)),
            np.empty(m),
            np.empty((m, 8, COMPONENTS)),
            slot,
            np.empty((k if problem.friction > 0.0 else 0, 2 * mesh.bandwidth + 2)),
        )
