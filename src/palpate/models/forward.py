"""What a forward model gives: responses under the conditions of a study, and their derivatives, at several points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import numpy as np

from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.mechanisms import Mechanism, Scale
from palpate.models.coordinates import Coordinates
from palpate.study.specification import Specification

Curves = Mapping[str, np.ndarray]


class Forward(Protocol):
    """A forward model, which gives a search curves and tangents.

    Both are lists with one entry for each of the points (k,); where a simulation failed, or a body is none that can be
    simulated, it is the reason.
    """

    @property
    def coordinates(self) -> Coordinates:
        """Of the points."""

    def under(self, names: Sequence[str]) -> Forward:
        """Return the model under other conditions."""

    def at_one_load(
        self, observed: Mapping[str, Observation], values: Mapping[str, float], report: Callable[[str], None]
    ) -> dict[str, Observation]:
        """Return what was observed with each replicate under the load of its condition, by the material's `values`."""

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> Forward:
        """Return the model with mechanisms, whose amplitudes are further coordinates."""

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Return what is simulated at coordinates u (k,) under a condition."""

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates u (k,), by its key."""

    def reanchored(self, u: np.ndarray) -> Forward:
        """Return the model of record, the most accurate one, anchored near coordinates u (k,)."""

    def refined(self, u: np.ndarray) -> Forward | None:
        """Return the same with the curves of finer meshes at coordinates u (k,) and near by; None without."""

    def extrapolated(self, u: np.ndarray) -> tuple[Forward, Curves, Curves] | None:
        """Return curves of finer meshes near coordinates u (k,) where the model of record's derivatives err.

        With them come the response (n_points,) and its derivatives (n_points, k) there. None elsewhere.
        """

    def consistent(self, u: np.ndarray, curves: Curves, slopes: Curves) -> Forward:
        """Return a model of record with these curves (n_points,) and slopes (n_points, k) at coordinates u (k,)."""

    def thinned(self) -> tuple[Forward, Mapping[str, np.ndarray]]:
        """Return a cheaper model with fewer samples, and which of each condition's (n_points,) it keeps."""

    @property
    def refinements(self) -> Mapping[str, np.ndarray]:
        """What the refinement to the model of record changed (n_points,), by condition, where that is known."""

    def points_per_batch(self, u: np.ndarray) -> int:
        """Return how many points near coordinates u (k,) are simulated in about the time of one."""

    def curves(self, points: Sequence[np.ndarray]) -> list[Curves | str]:
        """Return the response under each condition (n_points,), in nm or mN."""

    def tangents(self, points: Sequence[np.ndarray]) -> list[tuple[Curves, Curves] | str]:
        """Return the responses (n_points,) and their derivatives by the coordinates (n_points, k)."""


def under_each(model: Forward, names: Sequence[str], u: np.ndarray) -> dict[str, np.ndarray | str]:
    """Return the curve (n_points,) at coordinates u (k,) under each condition, or why the model failed there."""
    if not names:
        return {}
    (together,) = model.under(names).curves([u])
    if not isinstance(together, str):
        return dict(together)
    if len(names) == 1:
        return {names[0]: together}
    return {name: curve for each in names for name, curve in under_each(model, [each], u).items()}
