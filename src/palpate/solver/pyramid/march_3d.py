"""From one time to a later one, in as many steps as convergence asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from palpate.errors import ConvergenceError
from palpate.solver.axisymmetric.march_cases import HALVINGS
from palpate.study.protocol import Protocol

State = TypeVar("State", bound=Any)


def march_by(
    step: Callable[[State, float, float, State], State],
    protocol: Protocol,
    state: State,
    before: State | None,
    target: float,
) -> tuple[State, State, int]:
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
    state, before, steps
        The state at `target`, the one before, and the number of steps.

    Raises
    ------
    ConvergenceError
        When steps of 2^-`HALVINGS` of the way do not converge either.
    """
    shortest = (target - state.time) / 2**HALVINGS
    length, taken = target - state.time, 0
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
        state, before, taken = after, state, taken + 1
        if end == target:
            return state, before, taken


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
