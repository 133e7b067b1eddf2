"""A step whose attraction changes the contact much: let it grow in parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

from palpate.errors import ConvergenceError

LEAST_PART = 1 / 32  # of the attraction, the least growth that is tried
State = TypeVar("State")


def grown(step: Callable[[Any, State], State], problem: Any, guess: State) -> State:
    """Return the state after a step whose attraction grows in parts, which may change the contact much.

    Each part repeats the whole step and begins where the part before it ended, so only the last one counts.

    Parameters
    ----------
    step
        Takes the problem, with an `adhesion` of part strength, and a guess of the state at the end of the step.

    Raises
    ------
    ConvergenceError
        When the smallest part does not converge either.
    """
    done, more = -0.25, 0.25
    while done < 1.0:
        part = min(done + more, 1.0)
        try:
            guess = step(replace(problem, adhesion=problem.adhesion.weakened(part)), guess)
            done, more = part, 1.5 * more
        except ConvergenceError:
            more *= 0.5
            if more < LEAST_PART or done < 0.0:
                raise
    return guess
