"""The parts of tests in which effects and misfits are sought: the segments of each test, and their halves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeVar

import numpy as np

from palpate.configuration.condition import Condition
from palpate.inference.discrepancy import largest_depths
from palpate.inference.problem import Problem
from palpate.study.prescribed_segments import segments
from palpate.study.protocol import Protocol

DEGREE = 2  # of the polynomials over segments
Name = TypeVar("Name")  # of a segment, or of one of a cycle
Split = Callable[[Protocol], dict[Name, np.ndarray]]  # which samples (bool, n) belong to each


def in_segments(problem: Problem, split: Split[Name]) -> Iterator[tuple[Condition, Name, np.ndarray]]:
    """Yield each segment of each test with the places (n,) of its samples among those of all tests.

    The segments are those of a `split`: `segments` or `by_cycle` of `palpate.study.prescribed_segments`.
    """
    first = 0
    for condition in problem.conditions:
        for name, where in split(condition.protocol).items():
            yield condition, name, first + np.flatnonzero(where)
        first += len(condition.protocol.sample_time)


def halves(problem: Problem) -> Iterator[tuple[Condition, str, str, np.ndarray]]:
    """Yield condition, segment, ``early`` or ``late``, and places (n,) of each half of a segment."""
    for condition, segment, places in in_segments(problem, segments):
        for part, half in zip(("early", "late"), np.array_split(places, 2), strict=True):
            yield condition, segment, part, half


def mean_changes(problem: Problem, depth: np.ndarray) -> Iterator[np.ndarray]:
    """Yield weights (n_all,) that give the mean change of each half of a segment, as a share of the `depth` so far.

    The latter is that of the curves of all tests (n_all,) [nm].
    """
    largest = largest_depths(problem.split(depth), {})
    for _, _, _, half in halves(problem):
        weights = np.zeros(len(depth))
        weights[half] = 1.0 / largest[half].sum()
        yield weights


def polynomials(problem: Problem, split: Split[Name]) -> Iterator[tuple[Condition, Name, np.ndarray]]:
    """Yield 1, x and x^2 over each segment as columns (n_all, 3), as `in_segments` does."""
    for condition, name, places in in_segments(problem, split):
        columns = np.zeros((len(problem.mean), DEGREE + 1))
        columns[places] = np.vander(np.linspace(-1, 1, len(places)), DEGREE + 1)
        yield condition, name, columns
