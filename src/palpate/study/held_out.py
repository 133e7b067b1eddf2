"""Parts of a test that are held out: simulated and compared with its recordings, but in no likelihood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from palpate.errors import InputError
from palpate.study.protocol import Protocol

Parts = tuple[tuple[float, float], ...]  # (from, to) [s], in order, the ends included
BEYOND = 1e-3  # of the test, by which the end of a part may exceed that of the test: clocks are rounded
LEAST = 2  # samples in a part


def inside(time: np.ndarray, parts: Parts) -> np.ndarray:
    """Return which times (n,) [s] lie in a part that is held out, shape (n,)."""
    return np.any([(begin <= time) & (time <= end) for begin, end in parts] or [np.zeros(len(time), bool)], axis=0)


def divided(protocol: Protocol, given: Sequence[Sequence[float]], least: int) -> tuple[Parts, Protocol, Protocol]:
    """Return the parts in order, and the same history sampled at the times that count, and at those held out.

    Parameters
    ----------
    protocol
        Of the whole test.
    given
        Begin and end of each part [s].
    least
        Samples that must count.

    Raises
    ------
    InputError
        When a part has no length, lies outside of the test or overlaps another one, when no samples lie in a part, or
        too few are left.
    """
    parts = tuple(sorted((float(begin), float(end)) for begin, end in given))
    duration, time = float(protocol.knot_time[-1]), protocol.sample_time
    for begin, end in parts:
        if begin >= end:
            _refuse(f"a part from {begin:g} to {end:g} s has no length", "give [FROM_S, TO_S] with FROM_S before TO_S")
        if begin < 0.0 or end > duration * (1.0 + BEYOND):
            _refuse(f"a part from {begin:g} to {end:g} s leaves the test, of 0 to {duration:.6g} s", "keep it within")
        if inside(time, ((begin, end),)).sum() < LEAST:
            _refuse(
                f"fewer than {LEAST} simulated points lie between {begin:g} and {end:g} s", "widen it, or add points"
            )
    for (_, end), (begin, _) in pairwise(parts):
        if begin < end:
            _refuse(f"two parts overlap, from {begin:g} to {end:g} s", "join them, or move one")
    out = inside(time, parts)
    if len(time) - out.sum() < least:
        _refuse(f"of {len(time)} simulated points {len(time) - out.sum()} are left to be fitted", "hold less of it out")
    return parts, replace(protocol, sample_time=time[~out]), replace(protocol, sample_time=time[out])


def _refuse(problem: str, remedy: str) -> None:
    raise InputError(problem, remedy=remedy, place="held_out")
