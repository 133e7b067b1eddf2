"""Derivatives of the anchors of friction, and of the friction that follows from them."""

from __future__ import annotations

import numpy as np

from palpate.fem.contact import Contact
from palpate.fem.directions import Directions, change_beneath, profile_change
from palpate.fem.friction import ELASTIC_SLIP
from palpate.fem.newton import Problem, State


class AnchorChange:
    """The derivatives (k, p) of the anchors of the surface nodes [um per unit of the parameter].

    Parameters
    ----------
    problem : Problem
    directions : Directions
        Derivatives of its inputs.
    """

    def __init__(self, problem: Problem, directions: Directions):
        self.problem, self.directions = problem, directions
        r = problem.mesh.nodes[problem.mesh.surface, 0]
        self._reach = ELASTIC_SLIP * profile_change(problem.profile, directions, np.maximum(r, r[1]))[0]
        self._anchor = np.zeros_like(self._reach)

    def join(
        self,
        state: State,
        guess: State,
        contact: Contact,
        d_state: np.ndarray,
        d_guess: np.ndarray,
        d_depth: np.ndarray,
        d_ahead: np.ndarray,
    ) -> None:
        """Begin the anchors of nodes that came to touch, where `palpate.fem.contact.Contact.follow` put them.

        A node that only a later iteration found is taken to close its gap at the same part of the step.

        Parameters
        ----------
        state, guess : State
            Start of the step, and the guess of its end.
        d_state, d_guess : ndarray, shape (n, 2, p)
            Derivatives of their displacements.
        d_depth, d_ahead : ndarray, shape (p,)
            Derivatives of their depths.
        """
        new = np.isnan(state.anchor) & ~np.isnan(contact.anchor)
        if not new.any():
            return
        nodes, drift = contact.surface[new], contact.drift[new, None]
        opening, d_opening = self._gap(contact.r[new], nodes, state, d_state, d_depth)
        gap, d_gap = self._gap(contact.r[new], nodes, guess, d_guess, d_ahead)
        found = gap < 0.0
        closed = np.where(found, opening - gap, 1.0)
        d_closing = np.where(found, (opening * d_gap - gap * d_opening) / closed**2, 0.0)
        moves = drift != 0.0
        part = (contact.anchor - contact.start)[new, None] / np.where(moves, drift, 1.0)
        d_drift = np.where(moves, d_guess[nodes, 0] - d_state[nodes, 0], 0.0)
        self._anchor[new] = d_state[nodes, 0] + part * d_drift + d_closing * drift

    def _gap(
        self, r: np.ndarray, nodes: np.ndarray, state: State, d_u: np.ndarray, d_depth: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        profile, large, moved = self.problem.profile, self.problem.large, state.displacement[nodes, 0]
        height, slope, _ = profile.beneath(r, moved, large)
        gap = height - state.depth - state.displacement[nodes, 1]
        lift, _ = change_beneath(profile, self.directions, r, moved, large)
        return gap[:, None], slope[:, None] * d_u[nodes, 0] + lift - d_depth - d_u[nodes, 1]

    def ratio(self, contact: Contact) -> np.ndarray:
        """Return the change (k, p) of m at fixed displacements."""
        slip, reach = contact.slip[:, None], contact.friction.reach[:, None]
        moved = -(self._anchor + slip * self._reach) / reach
        sticks = np.abs(slip) < 1.0
        return np.clip(slip, -1.0, 1.0) * self.directions.friction + np.where(
            sticks, contact.friction.coefficient * moved, 0.0
        )

    def drag(self, contact: Contact, distance: np.ndarray, d_distance: np.ndarray) -> None:
        """Let the anchors of nodes that slip follow their `distance` (k,) [um], whose derivatives (k, p) are known."""
        slip = contact.friction.slip(distance, contact.anchor)[:, None]
        dragged = d_distance - np.sign(slip) * self._reach
        self._anchor = np.where(np.abs(slip) >= 1.0, dragged, self._anchor)
