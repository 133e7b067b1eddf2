"""From one time to a later one, in as many steps as convergence asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from palpate.errors import ConvergenceError
from palpate.solver.axisymmetric.indentation_case import HALVINGS
from palpate.solver.pyramid.problem_3d import State
from palpate.study.protocol import Protocol


def march_by(
    step: Callable[[State, float, float, State], State],
    protocol: Protocol,
    state: State,
    before: State | None,
    target: float,
) -> tuple[State, State]:
    """March to `target`, halving what does not converge.

    Parameters
    ----------
    step
        Takes a state, the time [s] and the load [mN] at the end of a step and a guess of the state there; returns it.
    protocol
        What load acts when.
    state, before
        Where to begin, and the state before that, if the guess may carry the last change on.
    target
        Where to end [s].

    Returns
    -------
    state, before
        The state at `target`, and the one before.

    Raises
    ------
    ConvergenceError
        When steps of 2^-`HALVINGS` of the way do not converge either.
    """
    length = target - state.time
    shortest = length / 2**HALVINGS
    while True:
        end = target if state.time + 1.5 * length > target else state.time + length
        load = float(protocol.load_at(np.array(end)))
        try:
            after = step(state, end, load, extrapolate(state, before, end))
        except ConvergenceError:
            if before is None and 0.5 * length < shortest:
                raise
            length, before = max(0.5 * length, shortest), None
            continue
        state, before = after, state
        if end == target:
            return state, before


def extrapolate(state: State, before: State | None, time: float) -> State:
    """Guess the next state by carrying the last change on."""
    if before is None or state.time == before.time:
        return state
    ratio = (time - state.time) / (state.time - before.time)
    return replace(
        state,
        displacement=state.displacement + ratio * (state.displacement - before.displacement),
        depth=state.depth + ratio * (state.depth - before.depth),
    )
