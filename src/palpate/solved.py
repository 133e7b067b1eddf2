"""The solver's curves of a study at given parameters: no more simulations than differ, several parameters at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from palpate.config import Study
from palpate.errors import PalpateError
from palpate.model import alike, simulate_batch


class SolvedCurves(Mapping):
    """Depth curves [nm] at given parameters by condition, solved when first asked for, with those that come free.

    Under a sharp tip conditions that differ in size alone are one simulation, see `palpate.fem.similar`.
    """

    def __init__(self, study: Study, values: Mapping[str, float], accuracy: str):
        self._study, self._values, self._accuracy = study, dict(values), accuracy
        self._depths: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._depths:
            specifications = {
                condition.name: self._study.specification(self._values, condition, self._accuracy)
                for condition in self._study.conditions
            }
            names = [other for other in self if alike(specifications[name], specifications[other])]
            self._depths |= solved(self._study, [self._values], names, self._accuracy)[0]
        return self._depths[name]

    def __iter__(self) -> Iterator[str]:
        return (condition.name for condition in self._study.conditions)

    def __len__(self) -> int:
        return len(self._study.conditions)


def solved(
    study: Study, points: Sequence[Mapping[str, float]], names: Sequence[str], accuracy: str
) -> list[dict[str, np.ndarray]]:
    """Return the depth curves [nm] of some conditions at each of several points, solved together.

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    places = [(k, name) for k in range(len(points)) for name in names]
    simulations = simulate_batch(study.specification(points[k], study.condition(n), accuracy) for k, n in places)
    curves: list[dict[str, np.ndarray]] = [{} for _ in points]
    for (k, name), simulation in zip(places, simulations, strict=True):
        if simulation.status != "ok":
            raise PalpateError(f"{name} at {dict(points[k])}: {simulation.reason}")
        curves[k][name] = simulation.depth
    return curves
