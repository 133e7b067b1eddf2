"""Failed snapshots: how many a surrogate tolerates, and where they lie."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from palpate.errors import PalpateError

MOST = 0.2  # of all snapshots; chosen: with more, leave-one-out errors do not show the errors in the gaps
END = 0.2  # of a range
MOST_AT_ONE_END = 0.5  # of those in the outer fifth of a parameter's range; chosen: beyond, it is no interpolation


def checked_missing(condition: str, cells: Sequence[Mapping[str, float]], failed: Sequence[bool]) -> str:
    """Return how many snapshots failed and where they lie, in a sentence; empty where none did.

    Parameters
    ----------
    cells
        Parameters of all snapshots by name.
    failed
        Which of them failed.

    Raises
    ------
    PalpateError
        When too many failed for a surrogate, altogether or at one end of a parameter's range.
    """
    lost = np.asarray(failed, dtype=bool)
    if not lost.any():
        return ""
    name, end, share = _worst_end(cells, lost)
    where = f", {100 * share:.0f} % of those at the {end} end of {name}" if name else ""
    found = f"{condition}: {lost.sum()} of {len(lost)} snapshots failed{where}"
    if lost.mean() > MOST or share > MOST_AT_ONE_END:
        raise PalpateError(
            f"{found}: too many for a surrogate; narrow the ranges of the parameters there (snapshots.csv lists the "
            "reasons)"
        )
    return f"{found}."


def _worst_end(cells: Sequence[Mapping[str, float]], lost: np.ndarray) -> tuple[str, str, float]:
    """Return the parameter, the end of its range (its outer fifth), and what share is lost there, at its largest."""
    worst = ("", "", 0.0)
    for name in cells[0]:
        values = np.array([cell[name] for cell in cells])
        span = values.max() - values.min()
        for end, inside in (("lower", values - values.min()), ("upper", values.max() - values)):
            outer = inside <= END * span
            if span > 0.0 and (share := float(lost[outer].mean())) > worst[2]:
                worst = (name, end, share)
    return worst
