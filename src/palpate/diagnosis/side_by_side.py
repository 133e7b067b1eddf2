"""Fits side by side: those that may be asked for next are begun where a core would be idle.

A search asks for one fit after another, and each answer decides whether the next one is worth its time. With several
threads the most likely ones are begun meanwhile; one that is not asked for is stopped at the end and dropped, so that
the answers do not depend on the number of threads. Compiled kernels run without the interpreter's lock.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event
from typing import Self

from palpate.diagnosis.search import Search
from palpate.inference.explanation import Fit


@dataclass(frozen=True, eq=False)
class ExplanationToTry:
    """An explanation that may be fitted: a smaller `fit` that a mechanism, `key`, joins.

    Its `log_evidence` is that to first order.
    """

    fit: Fit
    key: str
    log_evidence: float

    @property
    def members(self) -> frozenset[str]:
        """Its mechanisms."""
        return frozenset((*self.fit.explanation, self.key))


class ParallelFits:
    """Fits of explanations by a search, on `SearchPolicy.threads` threads, some begun before they are asked for."""

    def __init__(self, search: Search):
        self.search, self._pool = search, ThreadPoolExecutor(search.policy.threads)
        self._begun: dict[ExplanationToTry, Future[Fit]] = {}
        self._stop = Event()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._pool.shutdown(cancel_futures=True)

    def fitted(self, chosen: ExplanationToTry, likely: Sequence[ExplanationToTry]) -> Fit:
        """Fit the `chosen` explanation; the most `likely` next ones are begun where there are threads for them.

        Raises
        ------
        PalpateError
            When the forward model fails wherever the fit may begin.
        """
        for each in (chosen, *likely[: self.search.policy.threads - 1]):
            if each not in self._begun:
                self._begun[each] = self._pool.submit(self.search.joined, each.fit, each.key, self._stop)
        return self._begun.pop(chosen).result()
