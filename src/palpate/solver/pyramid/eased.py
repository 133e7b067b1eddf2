"""A step whose attraction changes the contact much: let it grow in parts."""

from __future__ import annotations

from dataclasses import replace

from palpate.errors import ConvergenceError
from palpate.solver.pyramid.newton_3d import advance
from palpate.solver.pyramid.problem_3d import Problem3D, State, Workspace

LEAST_PART = 1 / 32  # of the attraction, the least growth that is tried


def advance_or_ease(
    problem: Problem3D, work: Workspace, scale: float, state: State, time: float, load: float, guess: State
) -> State:
    """Do what `advance` does; where attraction keeps it from converging, let that grow in parts.

    Each part repeats the whole step and begins where the part before it ended, so only the last one counts. Arguments,
    result and errors are those of `palpate.solver.pyramid.newton_3d.advance`.
    """
    try:
        return advance(problem, work, scale, state, time, load, guess)
    except ConvergenceError:
        if (adhesion := problem.adhesion) is None:
            raise
    done, more, guess = -0.25, 0.25, state
    while done < 1.0:
        part = min(done + more, 1.0)
        eased = replace(problem, adhesion=adhesion.weakened(part))
        try:
            guess = advance(eased, work, scale, state, time, load, guess)
            done, more = part, 1.5 * more
        except ConvergenceError:
            more *= 0.5
            if more < LEAST_PART or done < 0.0:
                raise
    return guess
