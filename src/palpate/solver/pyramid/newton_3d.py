"""One time step in three dimensions: Newton's method on equilibrium, the material update and the contact together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.errors import ConvergenceError
from palpate.materials.flow.point import state_size
from palpate.materials.flow.row import step_weights
from palpate.solver.axisymmetric.adhesive_traction import Adhesion
from palpate.solver.axisymmetric.march import STRIDE
from palpate.solver.axisymmetric.regions import laws_of
from palpate.solver.pyramid.adhesion_3d import attract
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.coupled import Coupling3D, coupled_direction
from palpate.solver.pyramid.eased import grown
from palpate.solver.pyramid.element_3d import (
    CURVATURE_11,
    CURVATURE_22,
    Hexahedra,
    Laws3D,
    System3D,
    Touching,
    assemble,
    begin_step,
    end_step,
)
from palpate.solver.pyramid.linear_3d import COMPONENTS, Points3D
from palpate.solver.pyramid.linear_system import Search3D, newton_direction, retreat
from palpate.solver.pyramid.mesh_3d import Mesh3D
from palpate.solver.pyramid.tip_3d import Tip
from palpate.study.specimen import Specimen, halfway

ITERATIONS = 40  # of a step; chosen
ADHESIVE_ITERATIONS = 60  # a surface that jumps into contact takes many
TOLERANCE = 1e-7  # of the largest load on the wedge, which every unbalanced force falls below
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
    """Arrays of the linear system, allocated once a simulation, and a count of the work done."""

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray
    past: np.ndarray
    alpha: np.ndarray
    pressure: np.ndarray
    local: np.ndarray
    slot: np.ndarray
    pressing: np.ndarray
    iterations: int = 0

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
            np.empty((mesh.size, 2)),
            np.empty((m, 8, COMPONENTS)),
            np.empty((m, 8)),
            np.empty(m),
            np.empty((m, 8, COMPONENTS)),
            slot,
            np.empty((k if problem.friction > 0.0 else 0, 2 * mesh.bandwidth + 2)),
        )


def advance_or_ease(
    problem: Problem3D, work: Workspace, scale: float, state: State, time: float, load: float, guess: State
) -> State:
    """Do what `advance` does; where attraction keeps it from converging, let that grow in parts.

    Arguments, result and errors are those of `advance`.
    """
    try:
        return advance(problem, work, scale, state, time, load, guess)
    except ConvergenceError:
        if problem.adhesion is None:
            raise
    return grown(lambda eased, guess: advance(eased, work, scale, state, time, load, guess), problem, state)


def advance(
    problem: Problem3D, work: Workspace, scale: float, state: State, time: float, load: float, guess: State
) -> State:
    """Advance to `time` under `load` [mN]; forces converge to 1e-7 of `scale`, the largest load of the history.

    Parameters
    ----------
    problem
        What does not change.
    work
        Arrays of the linear system.
    scale
        Largest load of the history [mN].
    state
        At the start of the step.
    time, load
        At its end [s], [mN].
    guess
        State whose displacement and depth start the iteration.

    Raises
    ------
    ConvergenceError
        When the iteration limit is reached, an element turns inside out or the stiffness is not positive definite.
    """
    mesh, share, part = problem.mesh, load / WEDGES, scale / WEDGES
    midway = halfway(state.depth, state.load, load)
    coefficients = problem.coefficients
    weights = step_weights(coefficients, time - state.time, problem.specimen.resistance(1e3 * midway))
    displacement, depth, guesses = guess.displacement.copy(), guess.depth, state.guesses.copy()
    laws, points = Laws3D(problem.region, coefficients, weights), Points3D(work.past, work.alpha, guesses, work.local)
    begin_step(state.material, laws, points)
    contact = Contact3D.resume(problem, state, guess)
    force, forces = np.empty((len(mesh.nodes), 3)), np.empty(mesh.size + 1)
    hexahedra = Hexahedra.of(mesh)
    system = System3D(work.band, work.residual, work.border[:, 0], force, work.pressing, work.pressure)
    free, search, geometric, coupling = mesh.equations >= 0, None, True, None
    farthest, limit, delicate = np.inf, ITERATIONS, problem.adhesion is not None
    if problem.adhesion is not None:
        farthest = max(STRIDE * problem.adhesion.reach, np.abs(guess.displacement - state.displacement).max())
        limit = ADHESIVE_ITERATIONS
    for iteration in range(limit):
        same = contact.follow(displacement, depth)
        contact.rule[:, CURVATURE_11 : CURVATURE_22 + 1] *= geometric
        touching = Touching(contact.touching, contact.rule, work.slot)
        corner = assemble(displacement, hexahedra, laws, points, touching, system, problem.large, geometric)
        work.iterations += 1
        if not np.isfinite(corner):
            back = retreat(search, state.time)
            displacement[free] += back[:-1]
            depth += back[-1]
            continue
        if problem.adhesion is not None:
            corner += attract(problem.adhesion, contact, work, force, geometric)
        if problem.friction > 0.0:
            coupling = Coupling3D.add(contact, force, work.pressing, work.band, work.residual)
        pulled = contact.pulled(force, TOLERANCE * part)
        if iteration > 0 and pulled.any() and not contact.joined and contact.touching.sum() > 1:
            contact.release(pulled)
            search = None
            continue
        forces[:-1], forces[-1] = work.residual, -force[:, 2].sum() - share
        norm = np.abs(forces).max() / part
        if norm < TOLERANCE and not pulled.any() and not contact.joined:
            material = state.material.copy()
            end_step(material, laws, points, work.pressure)
            anchor = contact.anchors(displacement)
            return State(time, depth, displacement, material, contact.touching, guesses, force, anchor)
        if search is not None and same and (shorter := search.shorten(forces)) != 0.0:
            displacement[free] += shorter * search.direction[:-1]
            depth += shorter * search.direction[-1]
            continue
        if coupling is None:
            direction = newton_direction(work, forces, corner, definite=geometric and delicate)
        else:
            direction = coupled_direction(work, coupling, forces, corner)
        if direction is None:
            if not geometric:
                raise ConvergenceError("the stiffness lost its positive definiteness", time=state.time)
            geometric, search = False, None
            continue
        geometric = True
        if (largest := np.abs(direction).max()) > farthest:
            direction *= farthest / largest
        search = Search3D.along(direction, forces)
        displacement[free] += direction[:-1]
        depth += direction[-1]
    raise ConvergenceError(f"no equilibrium in {limit} iterations (imbalance {norm:.1e})", time=state.time)
