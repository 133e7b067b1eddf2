"""The model: curves and derivatives of the simulated body at a level of fidelity, and what the instrument adds."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.errors import InputError
from palpate.mechanisms import Mechanism, Scale
from palpate.models.coordinates import Coordinates
from palpate.models.fidelity import STUDY, Level
from palpate.models.forward import Curves
from palpate.solver.simulation import Simulation, differentiated, points_per_batch, simulate_batch
from palpate.solver.variation import Variation, added_by_instrument, applied_to_body
from palpate.study.specification import Specification, finer, of_equivalent_cone

NEAR = 3e-5  # of a range, over which a neighbour is carried along; derivatives err by about as much
ROUNDS = 6  # of the fixed point of the body's depth, each of which leaves a few per cent of the error
STEP = 1e-4  # of a range, over which what the instrument adds is differenced: it is linear or nearly so


@dataclass(eq=False)
class Spent:
    """Number of curves that were simulated of a body, at all levels; derivatives come with a curve."""

    curves: int = 0


@dataclass(frozen=True, eq=False)
class BodyModel:
    """The body under some conditions of a study.

    Parameters
    ----------
    study
    conditions
    coordinates
        Of the study's free parameters, and of the amplitudes of mechanisms.
    mechanisms
        That act, too.
    scale
        Size of the study, in which their amplitudes are searched for.
    level
        How closely it is simulated, see `at`.
    spent
        What was simulated so far, of this model and of all that were made of it.
    """

    study: Study
    conditions: Sequence[Condition]
    coordinates: Coordinates
    mechanisms: Sequence[Mechanism] = ()
    scale: Scale | None = None
    level: Level = STUDY
    spent: Spent = field(default_factory=Spent)

    def at(self, level: Level, all_samples: Collection[str] = ()) -> BodyModel:
        """Return the same at a level of fidelity; under the conditions of some names with all samples."""
        return replace(self, level=level, conditions=level.sampled(self.conditions, all_samples))

    def under(self, names: Collection[str]) -> BodyModel:
        """Return the same under other conditions of the study."""
        return replace(self, conditions=[self.study.condition(name) for name in names])

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> BodyModel:
        """Return the same with mechanisms, whose amplitudes are further coordinates."""
        coordinates = self.coordinates.joined(mechanisms, scale)
        return replace(self, coordinates=coordinates, mechanisms=(*self.mechanisms, *mechanisms), scale=scale)

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates u (k,), by its key."""
        if self.scale is None:
            return {}
        named, found = self.coordinates.named(u), {}
        for mechanism in self.mechanisms:
            searched = {name: named[f"{mechanism.key}.{name}"] for name in mechanism.searched(self.scale)}
            found[mechanism.key] = dict(mechanism.from_search(searched, self.scale))
        return found

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Return what is simulated at coordinates u (k,) under a condition: body and instrument."""
        named, accuracy = self.coordinates.named(u), finer(self.study.accuracy, self.level.degrees)
        found = self.study.specification({name: named[name] for name in self.study.levels}, condition, accuracy)
        found = replace(found, mechanisms=self.amplitudes(u))
        return found if self.level.pyramid else of_equivalent_cone(found)

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return the body's response (n_samples,) under each condition at each of the points (k,), in nm or mN.

        Where a simulation failed, or a body is none that can be simulated, it is the reason.
        """

        def simulated(some: Sequence[np.ndarray]) -> list[Simulation]:
            self.spent.curves += len(some) * len(self.conditions)
            return simulate_batch([b for u in some for b in self._bodies(u)], few_sectors=self.level.few_sectors)

        return [
            _failed(own) or {name: outcome.response for name, outcome in own.items()} if isinstance(own, dict) else own
            for own in self._at_each(points, simulated)
        ]

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """Return the same with the derivatives (n_samples, k) by the coordinates, see `curves`."""
        largest = self.coordinates.limits[1]

        def simulated(some: Sequence[np.ndarray]) -> list[tuple[Simulation, np.ndarray]]:
            rows: list[list[Variation]] = []
            for u in some:
                steps = np.where(u + NEAR <= largest, NEAR, -NEAR)
                moved = zip(*(self._bodies(place) for place in u + np.diag(steps)), strict=True)
                rows += [list(map(Variation, column, steps)) for column in moved]
            self.spent.curves += len(some) * len(self.conditions)
            bodies = [body for u in some for body in self._bodies(u)]
            return differentiated(bodies, rows, few_sectors=self.level.few_sectors)

        found: list[tuple[Curves, Curves] | str] = []
        for own in self._at_each(points, simulated):
            if isinstance(own, str):
                found.append(own)
                continue
            curves, slopes = ({name: pair[k] for name, pair in own.items()} for k in (0, 1))
            unknown = [f"{name}: a derivative is unknown" for name, s in slopes.items() if not np.isfinite(s).all()]
            failed = _failed(curves) or "".join(unknown[:1])
            found.append(failed or ({name: outcome.response for name, outcome in curves.items()}, slopes))
        return found

    def possible(self, u: np.ndarray) -> dict[str, np.ndarray]:
        """Return the body's curves (n_samples,) at coordinates u (k,) under the conditions where simulations succeed.

        A body may be impossible under a single condition, such as one that ends before the controller's lag.
        """
        (found,) = self.curves([u]) if self.conditions else [{}]
        if not isinstance(found, str):
            return dict(found)
        alone = [replace(self, conditions=[each]) for each in self.conditions] if self.conditions[1:] else []
        return {name: curve for each in alone for name, curve in each.possible(u).items()}

    def points_per_batch(self, u: np.ndarray) -> int:
        """Return how many points near coordinates u (k,) are simulated in about the time of one."""
        return points_per_batch(self._bodies(u), self.level.few_sectors)

    def instrument(self, u: np.ndarray, condition: Condition, body: np.ndarray) -> np.ndarray:
        """Return what the instrument adds (n_samples,) [nm] to the curve of the `body` at coordinates u (k,)."""
        return added_by_instrument(self.amplitudes(u), condition.protocol, body, condition.order)

    def instrument_slopes(
        self, u: np.ndarray, condition: Condition, body: np.ndarray, slopes: np.ndarray
    ) -> np.ndarray:
        """Return its derivatives (n_samples, k) by the coordinates.

        Parameters
        ----------
        u : ndarray, shape (k,)
            Coordinates.
        condition
            The test.
        body, slopes : ndarray, shapes (n_samples,) and (n_samples, k)
            Curve of the body [nm], and its derivatives.
        """
        here, steps = self.instrument(u, condition, body), STEP * np.eye(len(u))
        moved = [self.instrument(u + step, condition, body + slopes @ step) - here for step in steps]
        return np.stack(moved, axis=1) / STEP

    def without_instrument(self, u: np.ndarray, condition: Condition, recorded: np.ndarray) -> np.ndarray:
        """Return the curve of the body (n_samples,) to which the instrument added at coordinates u (k,).

        Where what it adds follows the depth it is a small part of it, and the fixed point is near.
        """
        body = recorded
        for _ in range(ROUNDS):
            body = recorded - self.instrument(u, condition, body)
        return body

    def _bodies(self, u: np.ndarray) -> list[Specification]:
        """Return the bodies that are simulated at coordinates u (k,), without what the instrument adds."""
        solids = [applied_to_body(self.specification(u, condition)) for condition in self.conditions]
        return [replace(solid, mechanisms={}) for solid in solids]

    def _at_each(
        self, points: Sequence[np.ndarray], simulated: Callable[[Sequence[np.ndarray]], Sequence[Any]]
    ) -> list[dict[str, Any] | str]:
        """Return what is simulated at each of the points (k,) by the names of the conditions; for no body, why."""
        try:
            outcomes = simulated(points)
        except InputError as error:
            return [found for u in points for found in self._at_each([u], simulated)] if points[1:] else [str(error)]
        names = [condition.name for condition in self.conditions]
        rows = [outcomes[first : first + len(names)] for first in range(0, len(outcomes), len(names))]
        return [dict(zip(names, row, strict=True)) for row in rows]


def _failed(outcomes: Mapping[str, Simulation]) -> str:
    """Return the first failure among simulations by the names of their conditions; empty where there is none."""
    return next((f"{name}: {each.reason}" for name, each in outcomes.items() if each.status != "ok"), "")
