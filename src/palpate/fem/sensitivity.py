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
from palpate.fem.contact import RATIO, SLOPE
from palpate.fem.directions import Directions, profile_change, resisted_change, weights_change
from palpate.fem.newton import Problem, State, Workspace
from palpate.fem.sensitivity_element import carry, push, settle


class Sensitivity:
    """The derivatives of a `State`, step after step.

    Parameters
    ----------
    problem : Problem
    directions : Directions
        Derivatives of its inputs.

    Attributes
    ----------
    depth : ndarray, shape (p,)
        [um per unit of the parameter]
    displacement : ndarray, shape (n, 2, p)
    material : ndarray, shape (m, 4, s, p)
    """

    def __init__(self, problem: Problem, directions: Directions):
        self.problem, self.directions = problem, directions
        initial, count = State.initial(problem), directions.count
        self.depth = np.zeros(count)
        self.displacement = np.zeros((*initial.displacement.shape, count))
        self.material = np.zeros((*initial.material.shape, count))
        self._before = np.zeros(count)

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
        mesh, contact, laws = problem.mesh, balance.contact, balance.coefficients
        ahead = self.depth.copy()
        if before is not None:
            ahead += (after.time - state.time) / (state.time - before.time) * (self.depth - self._before)
        midway, d_midway = 0.5e3 * (state.depth + guess.depth), 0.5e3 * (self.depth + ahead)
        d_laws = resisted_change(problem.coefficients, problem.specimen, directions, midway, d_midway)
        d_weights = weights_change(laws, d_laws, balance.step, np.zeros(directions.count))
        d_force = np.zeros_like(self.displacement)
        step = (mesh.elements, mesh.gradients, mesh.weights, problem.large, after.displacement, problem.region)
        carry(
            *step, laws, d_laws, balance.weights, d_weights, state.material, work.local, after.guesses, self.material,
            d_force,
        )  # fmt: skip
        surface = mesh.surface
        touching = after.contact[surface]
        r = contact.r + after.displacement[surface, 0]
        lift, turn = (np.where(touching[:, None], d, 0.0) for d in profile_change(problem.profile, directions, r))
        if directions.moves_tip:
            rise = np.zeros((len(mesh.nodes), directions.count))
            rise[surface] = lift
            push(
                *step, laws, balance.weights, work.past, work.alpha, work.deviatoric, work.dilatation, after.guesses,
                after.contact, rise, d_force,
            )  # fmt: skip
        slope, ratio = contact.rule[surface, SLOPE, None], contact.rule[surface, RATIO, None]
        radial, vertical = after.force[surface, 0, None], after.force[surface, 1, None]
        d_radial, d_vertical = d_force[surface, 0], d_force[surface, 1]
        along = (1.0 + ratio * slope) * d_radial + (slope - ratio) * d_vertical + turn * (ratio * radial + vertical)
        d_load = -d_vertical[touching].sum(axis=0)
        d_force[surface, 0] = np.where(touching[:, None], along, d_radial)
        d_force[surface, 1] = np.where(touching[:, None], 0.0, d_vertical)

        free = mesh.equations >= 0
        right = np.column_stack([d_force[free], work.border[:, 0]])
        solution = banded.solve(work.band, mesh.bandwidth, right, definite=False)
        if solution is None:
            raise ConvergenceError("the tangent at equilibrium cannot be factored", time=after.time)
        forward, sideways, row = solution[:, :-1], solution[:, -1], work.border[:, 1]
        self._before = self.depth
        self.depth = (row @ forward - d_load) / (balance.corner - row @ sideways)
        self.displacement[free] = -forward - sideways[:, None] * self.depth
        followed = slope * self.displacement[surface, 0] + lift - self.depth
        self.displacement[surface, 1] = np.where(touching[:, None], followed, self.displacement[surface, 1])
        settle(
            *step, laws, d_laws, balance.weights, d_weights, work.alpha, work.local, after.guesses, self.displacement,
            self.material,
        )  # fmt: skip
