"""Errors that palpate raises on purpose: those of bad input, which the readers of files share, and the solver's own."""

from __future__ import annotations

from indentation_files.errors import InputError, PalpateError, located_in, of_system, part_of

__all__ = ["ConvergenceError", "InputError", "PalpateError", "located_in", "of_system", "part_of"]


class ConvergenceError(PalpateError):
    """The solver could not complete a load history.

    Parameters
    ----------
    reason
        What failed.
    time
        Time reached [s].
    """

    def __init__(self, reason: str, *, time: float):
        self.reason, self.time = reason, time
        super().__init__(f"{reason} (time reached: {time:.6g} s)")
