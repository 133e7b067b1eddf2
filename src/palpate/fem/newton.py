"""One time step: Newton's method on equilibrium, the material update and the contact set together."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from palpate.errors import ConvergenceError
from palpate.fem import banded
from palpate.fem.adhesion import Adhesion
from palpate.fem.contact import CURVATURE, Contact
from palpate.fem.element import assemble, begin_step, end_step
from palpate.fem.linear import fixed_matrices
from palpate.fem.mesh import Mesh
from palpate.fem.profile import Profile
from palpate.fem.scalar_radial import resisted, state_size, step_weights
from palpate.specimen import Specimen, halfway

ITERATIONS = 40  # the nodes that a rounded tip lets go before it lifts off take many
ADHESIVE_ITERATIONS = 60  # a surface that jumps into contact takes many
CAREFUL_ITERATIONS = 150
NEAR = 1e-3  # imbalance at which the careful let nodes go
TOLERANCE = 1e-7
STRIDE = 2.0  # of the reach of adhesion, the farthest that one iteration moves a node


@dataclass(frozen=True, eq=False)
class Problem:
    """What does not change during a simulation.

    Parameters
    ----------
    mesh : Mesh
    profile : Profile
    specimen : Specimen
    coefficients : ndarray, shape (regions, c)
        Law of each region at large depth, see `palpate.fem.scalar_radial`.
    region : ndarray of int, shape (m,)
        Region of each element.
    large : bool
        Logarithmic instead of linear strains.
    friction : float
        Coulomb coefficient between indenter and body.
    adhesion
        Attraction between them.
    """

    mesh: Mesh
    profile: Profile
    specimen: Specimen
    coefficients: np.ndarray
    region: np.ndarray
    large: bool
    friction: float = 0.0
    adhesion: Adhesion | None = None

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
    displacement : ndarray, shape (n, 2)
    material : ndarray, shape (m, 4, s)
        State variables at the Gauss points.
    contact : ndarray of bool, shape (n,)
    guesses : ndarray, shape (m, 4)
        Last q at each Gauss point, where the next search begins.
    force : ndarray, shape (n, 2)
        Force of the indenter on the nodes, along r and z [mN].
    anchor : ndarray, shape (k,)
        Distance from the axis at which each surface node sticks [um]; NaN where it does not touch.
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
        """What the indenter presses with [mN]."""
        return -float(self.force[:, 1].sum())

    @classmethod
    def initial(cls, problem: Problem) -> State:
        """Return the unloaded body that the apex just touches."""
        n, m = len(problem.mesh.nodes), len(problem.mesh.elements)
        contact = np.zeros(n, dtype=bool)
        contact[0] = True
        material = np.zeros((m, 4, state_size(problem.coefficients[0])))
        anchor = np.full(len(problem.mesh.surface), np.nan)
        return cls(0.0, 0.0, np.zeros((n, 2)), material, contact, np.zeros((m, 4)), np.zeros((n, 2)), anchor)


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """What a converged step leaves behind for its derivatives, beside the tangent in the `Workspace`.

    Attributes
    ----------
    step : float
        Its duration [s].
    coefficients, weights : ndarray, shapes (regions, c) and (regions, w)
        The laws, and what the step makes of them.
    contact : Contact
    corner : float
        Diagonal entry of the depth in the tangent.
    """

    step: float
    coefficients: np.ndarray
    weights: np.ndarray
    contact: Contact
    corner: float


@dataclass
class Workspace:
    """Arrays of the linear system, allocated once a simulation, and a count of the work done.

    After a converged step `band` and `border` hold the tangent there, not factored yet.
    """

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray
    past: np.ndarray
    alpha: np.ndarray
    local: np.ndarray
    deviatoric: np.ndarray
    dilatation: np.ndarray
    equilibrium: Equilibrium | None = None
    iterations: int = 0
    norms: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, problem: Problem) -> Workspace:
        """Allocate for `problem`; friction and large strains make its matrix unsymmetric."""
        mesh = problem.mesh
        m = len(mesh.elements)
        return cls(
            banded.allocate(mesh.size, mesh.bandwidth, symmetric=problem.friction == 0.0 and not problem.large),
            np.empty(mesh.size),
            np.empty((mesh.size, 2)),
            np.empty((m, 4, 4)),
            np.empty((m, 4)),
            np.empty((m, 4, 4)),
            *fixed_matrices(mesh.gradients, mesh.weights),
        )


def advance(
    problem: Problem, state: State, time: float, load: float, scale: float, guess: State, work: Workspace,
    careful: bool = False,
) -> State:  # fmt: skip
    """Advance to `time` under `load`.

    Parameters
    ----------
    load
        Load at the end of the step [mN].
    scale
        Largest load of the history [mN]; forces converge to 1e-7 of it.
    guess
        State whose displacement and depth start the iteration.
    careful
        Whether iterations move nodes no farther than the depth may change, and let none go far from equilibrium: where
        much of the body flows without hardening it is so soft that they run away else. With friction, too, they then
        leave the stiffness that stress gives where it makes the matrix indefinite: the pressure in a body that hardly
        changes its volume does so far from equilibrium.

    Raises
    ------
    ConvergenceError
        When the iteration limit is reached or an element turns inside out.
    """
    mesh, profile = problem.mesh, problem.profile
    step = time - state.time
    midway = halfway(state.depth, state.load, load)
    coefficients = resisted(problem.coefficients, problem.specimen.resistance(1e3 * midway))
    weights = np.stack([step_weights(row, step) for row in coefficients])
    begin_step(state.material, problem.region, coefficients, weights, work.past, work.alpha)
    displacement, depth = guess.displacement.copy(), guess.depth
    guesses = state.guesses.copy()
    contact = Contact.resume(mesh, profile, problem.friction, problem.hold, problem.large, state, guess)
    force = np.empty((len(mesh.nodes), 2))
    free = mesh.equations >= 0
    diagonal = banded.diagonal(work.band, mesh.bandwidth)
    work.norms.clear()
    forces = np.zeros(mesh.size + 1)
    search, geometric = None, True
    delicate = problem.adhesion is not None or (problem.large and (careful or problem.friction == 0.0))
    farthest, limit, near = np.inf, ITERATIONS, np.inf
    if problem.adhesion is not None:
        farthest = max(STRIDE * problem.adhesion.reach, np.abs(guess.displacement - state.displacement).max())
        limit = ADHESIVE_ITERATIONS
    elif careful:
        farthest, limit, near = _stride(problem, state, guess), CAREFUL_ITERATIONS, NEAR
    for iteration in range(limit):
        same = contact.follow(displacement, depth)
        contact.rule[:, CURVATURE] *= geometric
        corner = assemble(
            displacement, mesh.elements, mesh.equations, mesh.gradients, mesh.weights, work.deviatoric, work.dilatation,
            problem.region, coefficients, weights, work.past, work.alpha, guesses, work.local, problem.large, geometric,
            contact.touching, contact.rule, work.band, diagonal, work.residual, work.border, force,
        )  # fmt: skip
        if problem.adhesion is not None:
            corner += problem.adhesion.add(contact, mesh, displacement, depth, work, diagonal, force, geometric)
        work.iterations += 1
        if not np.isfinite(corner):
            back = retreat(search, state.time)
            displacement[free] += back[:-1]
            depth += back[-1]
            continue
        forces[:-1], forces[-1] = work.residual, -force[:, 1].sum() - load
        norm = np.abs(forces).max() / scale
        pulled = contact.pulled(force, TOLERANCE * scale)
        if iteration > 0 and pulled.any() and norm < near and not contact.joined and contact.touching.sum() > 1:
            contact.release(pulled, force)
            search = None
            continue
        work.norms.append(norm)
        if norm < TOLERANCE and not pulled.any() and not contact.joined:
            material = state.material.copy()
            end_step(work.local, guesses, problem.region, coefficients, weights, material)
            anchor = contact.anchors(displacement)
            work.equilibrium = Equilibrium(step, coefficients, weights, contact, corner)
            return State(time, depth, displacement, material, contact.touching, guesses, force, anchor)
        if search is not None and same and (shorter := search.shorten(forces)) != 0.0:
            displacement[free] += shorter * search.direction[:-1]
            depth += shorter * search.direction[-1]
            continue
        definite = geometric and delicate
        direction = newton_direction(work, mesh.bandwidth, forces, corner, definite)
        if direction is None:
            if not geometric:
                raise ConvergenceError("the stiffness lost its positive definiteness", time=state.time)
            geometric, search = False, None
            continue
        geometric = True
        if (largest := np.abs(direction).max()) > farthest:
            direction *= farthest / largest
        search = Search.along(direction, forces)
        displacement[free] += direction[:-1]
        depth += direction[-1]
    raise ConvergenceError(f"no equilibrium in {limit} iterations (imbalance {norm:.1e})", time=state.time)


def _stride(problem: Problem, state: State, guess: State) -> float:
    """Return how far a careful iteration may move a node [um]: no farther than the depth is likely to change."""
    return max(abs(guess.depth - state.depth), 0.03 * state.depth, 0.1e-3 * problem.specimen.shallowest)


class LinearSystem(Protocol):
    """A banded matrix with its right-hand side, bordered by the depth: see `palpate.fem.element.assemble`."""

    band: np.ndarray
    residual: np.ndarray
    border: np.ndarray


def newton_direction(
    work: LinearSystem, bandwidth: int, forces: np.ndarray, corner: float, definite: bool
) -> np.ndarray | None:
    """Return the change (size + 1,) of displacements and depth that balances `forces` in the linearised system.

    None where the matrix cannot be factored, or ought to be positive definite (`definite`) and is not.
    """
    right = np.column_stack([work.residual, work.border[:, 0]])
    solution = banded.solve(work.band, bandwidth, right, definite)
    if solution is None:
        return None
    forward, sideways = solution.T
    row = work.border[:, 1]
    stiffness = corner - row @ sideways
    if definite and stiffness <= 0.0:
        return None
    change = (row @ forward - forces[-1]) / stiffness
    return np.append(-forward - change * sideways, change)


@dataclass
class Search:
    """A line search for the zero of the work of the residual along Newton's direction, by the secant.

    Without friction and large strains there is an incremental potential; its minimum is where that work vanishes.
    """

    direction: np.ndarray
    start: float
    fraction: float = 1.0
    tries: int = 0

    @classmethod
    def along(cls, direction: np.ndarray, forces: np.ndarray) -> Search:
        """Begin a search at the point whose out-of-balance `forces` gave the `direction`."""
        return cls(direction, float(direction @ forces))

    def halve(self) -> float:
        """Return how far to move back to halve the step."""
        self.fraction *= 0.5
        return -self.fraction

    def shorten(self, forces: np.ndarray) -> float:
        """Return how far to move along the direction again (negative: back), or zero to accept the point."""
        work = float(self.direction @ forces)
        if self.tries >= 5 or work * self.start > 0.0 or abs(work) < 0.8 * abs(self.start):
            return 0.0
        self.tries += 1
        fraction = self.fraction * max(0.1, self.start / (self.start - work))
        move, self.fraction = fraction - self.fraction, fraction
        return move


def retreat(search: Search | None, time: float) -> np.ndarray:
    """Return the change (size + 1,) of displacements and depth that leads back from where an element is inside out.

    Raises
    ------
    ConvergenceError
        When there is no way back.
    """
    if search is None or search.fraction < 0.01:
        raise ConvergenceError("an element turned inside out", time=time)
    return search.halve() * search.direction


def extrapolate(state: Any, before: Any, time: float) -> Any:
    """Guess the next state by carrying the last change on."""
    if before is None or state.time == before.time:
        return state
    ratio = (time - state.time) / (state.time - before.time)
    return replace(
        state,
        displacement=state.displacement + ratio * (state.displacement - before.displacement),
        depth=state.depth + ratio * (state.depth - before.depth),
    )
