"""Derivatives of a load history by parameters, carried along by direct differentiation.

At the end of every converged step the equations F(u, h; p) = 0 and sum F_z = P hold for every value of the parameters
p. Their derivative is linear in that of displacements u and depth h, with the tangent that Newton's method has just
assembled: one factorisation a step, and one more right-hand side a parameter. The contact set is held within a step, so
the derivatives are exact but for the values of the parameters at which a node joins or leaves.

Source: Michaleris, Tortorelli & Vidal, Int. J. Numer. Meth. Engng 37 (1994) 2471-2499, section 3.
"""

from __future__ import annotations

import numpy as np

from palpate.errors import ConvergenceError
from palpate.fem import banded
from palpate.fem.clock import Clock
from palpate.fem.contact import RATIO, SLOPE
from palpate.fem.directions import Directions, change_beneath, resisted_change, weights_change
from palpate.fem.newton import Equilibrium, Problem, State, Workspace
from palpate.fem.sensitivity_contact import AnchorChange
from palpate.fem.sensitivity_element import carry, push, settle
from palpate.fem.sensitivity_point import powers_size
from palpate.specimen import halfway, root_growth


class Sensitivity:
    """The derivatives of a `State`, step after step.

    Parameters
    ----------
    problem : Problem
    directions : Directions
        Derivatives of its inputs.
    clock : Clock
        Derivatives of the ends of its time steps.

    Attributes
    ----------
    depth : ndarray, shape (p,)
        [um per unit of the parameter]
    displacement : ndarray, shape (n, 2, p)
    material : ndarray, shape (m, 4, s, p)
    anchor : AnchorChange
    """

    def __init__(self, problem: Problem, directions: Directions, clock: Clock):
        self.problem, self.directions, self.clock = problem, directions, clock
        initial, count = State.initial(problem), directions.count
        self.depth = np.zeros(count)
        self.displacement = np.zeros((*initial.displacement.shape, count))
        self.material = np.zeros((*initial.material.shape, count))
        self.anchor = AnchorChange(problem, directions)
        self._powers = np.zeros((*initial.guesses.shape, powers_size(problem.coefficients[0])))
        self._depth_before, self._displacement_before = self.depth, self.displacement

    def follow(self, state: State, guess: State, after: State, before: State | None, work: Workspace) -> None:
        """Advance the derivatives from `state` to `after`, the step that has just converged.

        Parameters
        ----------
        guess
            Where its iteration began: `state`, or carried on from the one `before`.

        Raises
        ------
        ConvergenceError
            When the tangent cannot be factored.
        """
        problem, directions, balance = self.problem, self.directions, work.equilibrium
        assert balance is not None
        mesh, laws = problem.mesh, balance.coefficients
        (start, d_before), (end, d_load) = self.clock.changes(state.time), self.clock.changes(after.time)
        ahead, d_guess = self._guess(state, before, after.time)
        midway, growth = 1e3 * halfway(state.depth, state.load, after.load), root_growth(state.load, after.load)
        d_midway = 0.5e3 * (1.0 + growth) * self.depth
        if growth > 1.0:
            d_midway += 0.25e3 * state.depth * growth * (d_load / after.load - d_before / state.load)
        d_laws = resisted_change(problem.coefficients, problem.specimen, directions, midway, d_midway)
        d_weights = weights_change(laws, d_laws, balance.step, end - start)
        step = (mesh.elements, mesh.gradients, mesh.weights, problem.large, after.displacement, problem.region)
        changes = (laws, d_laws, balance.weights, d_weights)
        d_force = np.zeros_like(self.displacement)
        points = (work.alpha, work.local, after.guesses, self._powers)
        carry(*step, *changes, state.material, *points, self.material, d_force)

        surface = mesh.surface
        touching = after.contact[surface]
        r, moved = balance.contact.r, after.displacement[surface, 0]
        change = change_beneath(problem.profile, directions, r, moved, problem.large)
        lift, turn = (np.where(touching[:, None], d, 0.0) for d in change)
        if directions.moves_tip:
            rise = np.zeros((len(mesh.nodes), directions.count))
            rise[surface] = lift
            push(
                *step, laws, balance.weights, work.past, work.alpha, work.deviatoric, work.dilatation, after.guesses,
                after.contact, rise, d_force,
            )  # fmt: skip
        self.anchor.join(state, guess, balance.contact, self.displacement, d_guess, self.depth, ahead)
        d_ratio = self.anchor.ratio(balance.contact)
        d_supported = self._project(after, balance, turn, d_ratio, d_force)
        self._depth_before, self._displacement_before = self.depth, self.displacement
        self._solve(work, balance, d_force, -d_supported - d_load, after.time)
        followed = balance.contact.rule[surface, SLOPE, None] * self.displacement[surface, 0] + lift - self.depth
        self.displacement[surface, 1] = np.where(touching[:, None], followed, self.displacement[surface, 1])
        self.anchor.drag(balance.contact, r + moved, self.displacement[surface, 0])
        settle(*step, *changes, *points, self.displacement, self.material)

    def _guess(self, state: State, before: State | None, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of `palpate.fem.newton.extrapolate`: of the depth, and of the displacements."""
        if before is None:
            return self.depth, self.displacement
        past, ahead = state.time - before.time, time - state.time
        (first, _), (now, _), (last, _) = (self.clock.changes(t) for t in (before.time, state.time, time))
        ratio = ahead / past
        d_ratio = ratio * ((last - now) / ahead - (now - first) / past)
        depth = self.depth + ratio * (self.depth - self._depth_before) + d_ratio * (state.depth - before.depth)
        displacement = self.displacement + ratio * (self.displacement - self._displacement_before)
        if d_ratio.any():
            displacement += d_ratio * (state.displacement - before.displacement)[..., None]
        return depth, displacement

    def _project(
        self, after: State, balance: Equilibrium, turn: np.ndarray, d_ratio: np.ndarray, d_force: np.ndarray
    ) -> np.ndarray:
        """Replace forces on nodes that touch by balance along the generator, in place; return the change (p,) of load.

        Parameters
        ----------
        turn, d_ratio : ndarray, shape (k, p)
            Changes of df/dr and of the friction m at the surface nodes, at fixed displacements.
        """
        surface = self.problem.mesh.surface
        touching = after.contact[surface, None]
        slope, ratio = (balance.contact.rule[surface, k, None] for k in (SLOPE, RATIO))
        radial, vertical = (after.force[surface, k, None] for k in (0, 1))
        d_radial, d_vertical = d_force[surface, 0], d_force[surface, 1]
        along = (1.0 + ratio * slope) * d_radial + (slope - ratio) * d_vertical
        along += turn * (ratio * radial + vertical) + d_ratio * (slope * radial - vertical)
        d_force[surface, 0] = np.where(touching, along, d_radial)
        d_force[surface, 1] = np.where(touching, 0.0, d_vertical)
        return np.where(touching, d_vertical, 0.0).sum(axis=0)

    def _solve(
        self, work: Workspace, balance: Equilibrium, d_force: np.ndarray, d_missing: np.ndarray, time: float
    ) -> None:
        """Set the derivatives of depth and displacements from those of the forces at fixed displacements.

        Parameters
        ----------
        d_missing : ndarray, shape (p,)
            Change of what the load lacks.
        """
        mesh = self.problem.mesh
        free = mesh.equations >= 0
        right = np.column_stack([d_force[free], work.border[:, 0]])
        solution = banded.solve(work.band, mesh.bandwidth, right, definite=False)
        if solution is None:
            raise ConvergenceError("the tangent at equilibrium cannot be factored", time=time)
        forward, sideways, row = solution[:, :-1], solution[:, -1], work.border[:, 1]
        self.depth = (row @ forward - d_missing) / (balance.corner - row @ sideways)
        self.displacement = np.zeros_like(d_force)
        self.displacement[free] = -forward - sideways[:, None] * self.depth
