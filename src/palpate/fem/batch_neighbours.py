"""Indentations a little beside others, carried along with them: exact derivatives by any parameter.

The equations of equilibrium hold at every value of a parameter p. Their total derivative by p is linear in that of the
displacements, with the tangent of Newton's method, so that a converged step whose matrix is factored already costs one
more solution for each parameter (Michaleris, Tortorelli & Vidal, Int. J. Numer. Meth. Engng 37 (1994) 2471-2499,
section 3). Here the right-hand side is not derived term by term: a neighbour, whose parameter is changed by a
ten-thousandth, has a history of its own, and its residual where its host has just arrived is that right-hand side
times the change. Newton's correction with the factor of the host then brings it to its own equilibrium. Whatever a
law, a tip, a film, friction, adhesion or the drive does, its derivative follows without a line of its own.

A neighbour keeps the mesh and the steps of its host, so its curve is that of the same discretisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from palpate.fem.batch_contact import end_step
from palpate.fem.batch_march import March, States
from palpate.fem.batch_newton import correct, refactor

CORRECTIONS = 2  # with the factor of the host, whose matrix is not exactly the neighbour's


@dataclass(eq=False)
class Neighbours:
    """Neighbours of `LANES` indentations, one for each of some parameters.

    Parameters
    ----------
    host : March
    marches
        How each advances.
    states
        Where each has arrived.
    """

    host: March
    marches: Sequence[March]
    states: list[States]

    @classmethod
    def of(cls, host: March, begun: Sequence[tuple[March, States]]) -> Neighbours:
        """Return neighbours that have just begun."""
        return cls(host, [march for march, _ in begun], [states for _, states in begun])

    def follow(self, start: States, arrived: States, begin: np.ndarray, end: np.ndarray, lanes: np.ndarray) -> None:
        """Advance in some `lanes` (LANES,), whose hosts went from the `start` to where they `arrived`; times in s."""
        refactor(
            self.host.large, self.host.body, arrived.points, self.host.contact, arrived.contact, arrived.laws,
            arrived.displacement, arrived.depth, self.host.system,
        )  # fmt: skip
        for k, march in enumerate(self.marches):
            states = self.states[k] if lanes.all() else deepcopy(self.states[k])
            away, deeper = states.displacement - start.displacement, states.depth - start.depth
            wider = states.contact.area - start.contact.area
            march.open(states, begin, end)
            states.displacement, states.depth = arrived.displacement + away, arrived.depth + deeper
            states.contact.area[:] = arrived.contact.area + wider
            correct(
                march.large, march.body, states.points, march.contact, states.contact, states.laws, states.weights,
                march.drives.equation(end), states.displacement, states.depth, states.reaction, march.system, lanes,
                CORRECTIONS,
            )  # fmt: skip
            end_step(march.large, march.body, march.contact, states.contact, states.displacement, states.depth)
            if states is not self.states[k]:
                self.states[k].take(states, lanes)
