"""Parts of sentences that several messages share."""

from __future__ import annotations

from collections.abc import Sequence, Sized

import numpy as np

PLACES = 3  # that a message names


def and_more(found: Sized) -> str:
    """Return `` and 2 more`` for three things of which one is named; nothing for one."""
    return f" and {len(found) - 1} more" if len(found) > 1 else ""


def first_few(items: Sequence[int | str] | np.ndarray) -> str:
    """Return the first few of some numbers or names, and how many more there are."""
    more = f" and {len(items) - PLACES} more" if len(items) > PLACES else ""
    return ", ".join(str(item) for item in items[:PLACES]) + more
