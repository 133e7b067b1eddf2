"""From one time to the next in SIMD lanes, each lane in as many steps as its convergence asks for.

What does not converge is halved. Lanes that had found equilibrium keep it meanwhile, so that no lane depends on its
neighbours.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from palpate.solver.axisymmetric.bordered import System
from palpate.solver.axisymmetric.contact import ContactState, begin_step, end_step
from palpate.solver.axisymmetric.drive import Drives
from palpate.solver.axisymmetric.law_lanes import Points, commit_and_begin
from palpate.solver.axisymmetric.newton import advance
from palpate.solver.axisymmetric.specimens import Specimens
from palpate.solver.axisymmetric.trial_state import Material, Prescribed, Setup, Trial
from palpate.study.specimen import halfway

LITTLE = 0.2  # of the area of the first contact that counts, below which there has been none
FARTHEST = 0.2  # of the depth, that one iteration moves a node
STRIDE = 2.0  # of the reach of adhesion, the farthest that one iteration moves a node


@dataclass(eq=False)
class States:
    """Everything that a step hands to the next one, `LANES` columns each; lengths are in units of the lanes.

    Attributes
    ----------
    points, contact
        See `palpate.solver.axisymmetric.law_lanes` and `palpate.solver.axisymmetric.contact`.
    laws, weights : ndarray, shape (1 or m, rows, LANES)
        Of the last step, see `palpate.solver.axisymmetric.specimens`.
    displacement : ndarray, shape (size + 1, LANES)
    depth, reaction : ndarray, shape (LANES,)
        Of the indenter; the reaction is its load.
    """

    points: Points
    contact: ContactState
    laws: np.ndarray
    weights: np.ndarray
    displacement: np.ndarray
    depth: np.ndarray
    reaction: np.ndarray

    @property
    def material(self) -> Material:
        """What compiled functions take of the material."""
        return Material(self.points, self.laws, self.weights)

    @property
    def trial(self) -> Trial:
        """What compiled functions take of contact and unknowns."""
        return Trial(self.contact, self.displacement, self.depth, self.reaction)

    def take(self, other: States, lanes: np.ndarray | None = None) -> None:
        """Become what the `other` is, in all lanes or in some (LANES,)."""
        if lanes is None or lanes.any():
            for mine, theirs in zip(self._arrays(), other._arrays(), strict=True):
                np.copyto(mine, theirs, where=True if lanes is None else lanes)

    @property
    def unknowns(self) -> np.ndarray:
        """Displacements, depth and the logarithm of the area of contact (size + 3, LANES)."""
        return np.vstack([self.displacement, self.depth, np.log(self.contact.area)])

    def add(self, change: np.ndarray) -> None:
        """Change the unknowns (size + 3, LANES)."""
        self.displacement, self.depth = self.displacement + change[:-2], self.depth + change[-2]
        self.contact.area[:] *= np.exp(change[-1])

    def _arrays(self) -> list[np.ndarray]:
        own = [self.laws, self.weights, self.displacement, self.depth, self.reaction]
        return [*self.points, *self.contact, *own]


@dataclass(frozen=True, eq=False)
class March:
    """How `LANES` indentations advance together.

    Parameters
    ----------
    setup : Setup
    bodies : Specimens
    drives : Drives
        What is prescribed.
    units : ndarray, shape (LANES,)
        Unit of length of each lane [um].
    system : System
    tolerance
        See `palpate.solver.axisymmetric.newton.advance`.
    onset : ndarray, shape (2, LANES)
        Area of the first contact that counts, and the depth that its iteration begins with.
    halvings : ndarray of int, shape (LANES,)
        Of a step that finds no equilibrium.
    """

    setup: Setup
    bodies: Specimens
    drives: Drives
    units: np.ndarray
    system: System
    tolerance: float
    onset: np.ndarray
    halvings: np.ndarray

    def prescribed(self, end: np.ndarray) -> Prescribed:
        """Return what is prescribed at times (LANES,) [s]."""
        return Prescribed(*self.drives.equation(end), self.drives.scale, self.tolerance)

    def step(
        self, states: States, begin: np.ndarray, end: np.ndarray, change: np.ndarray, lanes: np.ndarray
    ) -> np.ndarray:
        """Bring some lanes from one time to another [s] in one step, which a guess of the change starts.

        Parameters
        ----------
        states
            In: at the time `begin`; out: at `end` in the lanes that are returned, and nothing of use in others.
        begin, end : ndarray, shape (LANES,)
        change : ndarray, shape (size + 3, LANES)
        lanes : ndarray of bool, shape (LANES,)

        Returns
        -------
        found : ndarray of bool, shape (LANES,)
            The lanes that found equilibrium.
        """
        self.open(states, begin, end)
        states.add(change)
        self._begin_contact(states)
        found = lanes.copy()
        advance(
            self.setup, states.material, states.trial, self.prescribed(end), self.system,
            self.stride(states, change), found,
        )  # fmt: skip
        end_step(self.setup, states.trial)
        return found

    def _begin_contact(self, states: States) -> None:
        """Let the tip overlap the surface where it has not touched as much as by the first load."""
        (area, depth), first = self.onset, self._first(states)
        states.depth = np.where(first, np.maximum(states.depth, depth), states.depth)
        states.contact.area[first] = area[first]

    def _first(self, states: States) -> np.ndarray:
        """Return whether lanes have not touched much so far; with adhesion, whether at all."""
        little = np.where(self.setup.contact.strength > 0.0, 0.0, LITTLE) * self.onset[0]
        return states.contact.widest <= little

    def open(self, states: States, begin: np.ndarray, end: np.ndarray) -> None:
        """Open a step from one time to another [s]: laws and weights at its middle, and what the history fixes."""
        begin_step(self.setup, states.trial)
        midway = np.array(list(map(halfway, states.depth, self.drives.loading(begin), self.drives.loading(end))))
        resisting, following = self.bodies.at(1e3 * self.units * midway, end - begin)
        commit_and_begin(states.points, states.laws, states.weights, following)
        states.laws, states.weights = resisting, following

    def stride(self, states: States, change: np.ndarray) -> np.ndarray:
        """Return the farthest (LANES,) that one iteration may move a node of a step with a guess of its `change`.

        A share of the depth, lest the tip leaves the surface for good; with adhesion, what its attraction spans.
        """
        largest = np.abs(change[:-2]).max(axis=0)
        rise = states.contact.rise * self.setup.contact.width[-1]
        free = np.maximum(FARTHEST * np.abs(states.depth) + rise, largest)
        held = np.maximum(
            STRIDE * self.setup.contact.reach, np.maximum(largest, np.where(self._first(states), states.depth, 0.0))
        )
        return np.where(self.setup.contact.attraction.any(axis=0), held, free)

    def in_parts(
        self, states: States, start: States, begin: np.ndarray, end: np.ndarray, parts: np.ndarray, lanes: np.ndarray,
        follow: Callable[[States, States, np.ndarray, np.ndarray, np.ndarray], None] | None = None,
    ) -> np.ndarray:  # fmt: skip
        """Bring some lanes from one time to another [s] in equal parts to begin with, halved where it must be.

        Parameters
        ----------
        states
            Out: at the time `end` in the lanes that are returned; other lanes keep what they are.
        start
            At the time `begin`; spent by this.
        begin, end, parts, lanes : ndarray, shape (LANES,)
        follow
            Called after each part: with the states before and after, both times, and the lanes that found equilibrium.

        Returns
        -------
        found : ndarray of bool, shape (LANES,)
            The lanes that found equilibrium all the way.
        """
        # `start` is where each lane has arrived, `trial` where a part of the step leads, `states` the answer. Lanes
        # that wait make a step whose outcome is not taken.
        trial, time = deepcopy(start), begin.copy()
        length, shortest = (end - begin) / parts, (end - begin) / 2.0**self.halvings
        going, still = lanes.copy(), np.zeros_like(start.unknowns)
        while going.any():
            # The last part may be half a part longer, so that no sliver is left.
            target = np.where(time + 1.5 * length > end, end, time + length)
            found = self.step(trial, np.where(going, time, begin), np.where(going, target, end), still, going)
            lost = going & ~found
            if follow and found.any():
                follow(start, trial, np.where(going, time, begin), np.where(going, target, end), found)
            start.take(trial, found)
            trial.take(start)
            time = np.where(found, target, time)
            length = np.where(lost, 0.5 * length, length)
            going &= (time < end) & (length >= shortest)
        arrived = lanes & (time == end)
        states.take(start, arrived)
        return arrived
