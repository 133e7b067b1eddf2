"""Parts of sentences that several messages share."""

from __future__ import annotations

from collections.abc import Sized


def and_more(found: Sized) -> str:
    """Return `` and 2 more`` for three things of which one is named; nothing for one."""
    return f" and {len(found) - 1} more" if len(found) > 1 else ""
