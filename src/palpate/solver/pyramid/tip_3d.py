"""The surface of a rigid indenter above its apex, over the wedge that is simulated: z = f(x, y)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate.solver.axisymmetric.profile import Profile
from palpate.solver.pyramid.shell import EDGE
from palpate.study.indenter import Indenter

Tip = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def tip_of(indenter: Indenter) -> Tip:
    """Return the function of x and y (k,) [um] that gives f (k,), its gradient (k, 2) and its curvatures (k, 2, 2)."""
    if indenter.shape == "berkovich":
        ball = indenter.radius * 1e-3
        return rounded_pyramid(indenter.face_slope, ball) if ball else pyramid(indenter.face_slope)
    return of_revolution(Profile.of(indenter))


def pyramid(slope: float) -> Tip:
    """Return a pyramid's face, the plane f = slope x: the wedge holds half of one face."""

    def face(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return slope * x, np.stack([np.full_like(x, slope), np.zeros_like(x)], axis=-1), np.zeros((*x.shape, 2, 2))

    return face


def rounded_pyramid(slope: float, radius: float) -> Tip:
    """Return a pyramid whose edges and apex are those of a ball of `radius` [um] that rolls inside it.

    In the apex that is a cap, f = R - sqrt(R^2 - r^2), as far as its normal leans no more than the edge does, along the
    edge, which rises by k = slope / 2, part of a cylinder, and beyond the face. With t along the edge's direction, s
    across it and x towards the middle of the face,

        f = R + k t - sqrt(1 + k^2) sqrt(R^2 - s^2)    and    f = R + slope x - R sqrt(1 + slope^2).

    All three meet tangentially.
    """
    edge, across = EDGE[:2], np.array([EDGE[1], -EDGE[0]])
    rise = slope * edge[0]
    lean = np.sqrt(1.0 + rise**2)
    rim = radius * slope * across[0] / np.sqrt(1.0 + slope**2)

    def surface(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        place = np.stack([x, y], axis=-1)
        along, beside, square = place @ edge, place @ across, x**2 + y**2
        cap = np.sqrt(np.maximum(radius**2 - square, 0.0))
        on_cap = (along <= rise * cap) & (square < radius**2)
        cap = np.where(on_cap, cap, 1.0)
        face = ~on_cap & (beside >= rim)
        chord = np.sqrt(radius**2 - np.minimum(beside, rim) ** 2)
        where = [on_cap, face]
        height = np.select(
            where,
            [radius - cap, radius + slope * x - radius * np.sqrt(1.0 + slope**2)],
            radius + rise * along - lean * chord,
        )
        gradient = np.select(
            [part[:, None] for part in where],
            [place / cap[:, None], np.array([slope, 0.0])],
            rise * edge + (lean * beside / chord)[:, None] * across,
        )
        curvature = np.select(
            [part[:, None, None] for part in where],
            [
                np.eye(2) / cap[:, None, None] + place[:, :, None] * place[:, None, :] / cap[:, None, None] ** 3,
                np.zeros((2, 2)),
            ],
            (lean * radius**2 / chord**3)[:, None, None] * np.outer(across, across),
        )
        return height, gradient, curvature

    return surface


def of_revolution(profile: Profile) -> Tip:
    """Return a cone, a sphere or a rounded cone."""

    def surface(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        r = np.hypot(x, y)
        height, slope, curvature = profile(r)
        outward = np.stack([x, y], axis=-1) / np.where(r > 0.0, r, np.inf)[:, None]
        along = outward[:, :, None] * outward[:, None, :]
        around = np.where(r > 0.0, slope / np.where(r > 0.0, r, 1.0), 0.0)[:, None, None] * (np.eye(2) - along)
        return height, slope[:, None] * outward, curvature[:, None, None] * along + around

    return surface
