"""The solver's curves of a study at given parameters: no more simulations than differ, several parameters at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from palpate.config import Study
from palpate.errors import PalpateError
from palpate.model import alike, simulate_batch


class SolvedCurves(Mapping):
    """Curves by condition at one of several points, solved when first asked for, with those that come free.

    They are of what answers: depth [nm], or load [mN] under displacement control.

    A condition that is asked for at one point is solved for all points, together. Under a sharp tip conditions that
    differ in size alone are one simulation, see `palpate.fem.similar`.

    Raises
    ------
    PalpateError
        When the solver fails at any of the points for a condition that is asked for.
    """

    def __init__(
        self,
        study: Study,
        points: Sequence[Mapping[str, float]],
        accuracy: str,
        curves: Sequence[dict[str, np.ndarray]],
        place: int,
    ):
        self._study, self._points, self._accuracy = study, points, accuracy
        self._curves, self._place = curves, place

    @classmethod
    def at(cls, study: Study, points: Sequence[Mapping[str, float]], accuracy: str) -> list[SolvedCurves]:
        """Return the curves at several points, given by the names of the parameters."""
        curves: list[dict[str, np.ndarray]] = [{} for _ in points]
        return [cls(study, points, accuracy, curves, place) for place in range(len(points))]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._curves[self._place]:
            first = {
                condition.name: self._study.specification(self._points[0], condition, self._accuracy)
                for condition in self._study.conditions
            }
            self._solve([other for other in self if alike(first[name], first[other])])
        return self._curves[self._place][name]

    def __iter__(self) -> Iterator[str]:
        return (condition.name for condition in self._study.conditions)

    def __len__(self) -> int:
        return len(self._study.conditions)

    def _solve(self, names: Sequence[str]) -> None:
        study, points = self._study, self._points
        places = [(k, name) for k in range(len(points)) for name in names]
        simulations = simulate_batch(
            study.specification(points[k], study.condition(name), self._accuracy) for k, name in places
        )
        for (k, name), simulation in zip(places, simulations, strict=True):
            if simulation.status != "ok":
                raise PalpateError(f"{name} at {dict(points[k])}: {simulation.reason}")
            self._curves[k][name] = simulation.response
