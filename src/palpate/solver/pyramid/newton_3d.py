"""One time step in three dimensions: Newton's method on equilibrium, the material update and the contact together."""

from __future__ import annotations

import numpy as np

from palpate.errors import ConvergenceError
from palpate.materials.flow.row import step_weights
from palpate.solver.axisymmetric.march import STRIDE
from palpate.solver.pyramid.adhesion_3d import attract
from palpate.solver.pyramid.contact_3d import Contact3D
from palpate.solver.pyramid.coupled import Coupling3D, coupled_direction
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
from palpate.solver.pyramid.linear_3d import Points3D
from palpate.solver.pyramid.linear_system import Search3D, newton_direction, retreat
from palpate.solver.pyramid.problem_3d import WEDGES, Problem3D, State, Workspace
from palpate.study.specimen import halfway

ITERATIONS = 40  # of a step; chosen
ADHESIVE_ITERATIONS = 60  # a surface that jumps into contact takes many
TOLERANCE = 1e-7  # of the largest load on the wedge, which every unbalanced force falls below


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
    laws = Laws3D(problem.region, coefficients, weights)
    points = Points3D(work.past, work.back, work.alpha, guesses, work.local)
    begin_step(state.material, laws, points)
    contact = Contact3D.resume(problem, state, guess)
    force, forces = np.empty((len(mesh.nodes), 3)), np.empty(mesh.size + 1)
    hexahedra = Hexahedra.of(mesh)
    system = System3D(work.band, work.residual, work.border, force, work.pressing, work.pressure)
    free, search, geometric, coupling = mesh.equations >= 0, None, True, None
    farthest, limit = np.inf, ITERATIONS
    if problem.adhesion is not None:
        farthest = max(STRIDE * problem.adhesion.reach, np.abs(guess.displacement - state.displacement).max())
        limit = ADHESIVE_ITERATIONS
    for iteration in range(limit):
        same = contact.follow(displacement, depth)
        contact.rule[:, CURVATURE_11 : CURVATURE_22 + 1] *= geometric
        touching = Touching(contact.touching, contact.rule, work.slot)
        corner = assemble(displacement, hexahedra, laws, points, touching, system, problem.large, geometric)
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
            direction = newton_direction(work, forces, corner, definite=geometric and problem.adhesion is not None)
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
