"""The surface of a rigid indenter above its apex, over the wedge that is simulated: z = f(x, y)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from palpate.fem.profile import Profile
from palpate.indenters import Indenter

Tip = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def tip_of(indenter: Indenter) -> Tip:
    """Return the function of x and y (k,) [um] that gives f (k,), its gradient (k, 2) and its curvatures (k, 2, 2)."""
    if indenter.shape == "berkovich":
        return pyramid(indenter.face_slope)
    return of_revolution(Profile.of(indenter))


def pyramid(slope: float) -> Tip:
    """Return a pyramid's face, the plane f = slope x: the wedge holds half of one face."""

    def face(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return slope * x, np.stack([np.full_like(x, slope), np.zeros_like(x)], axis=-1), np.zeros((*x.shape, 2, 2))

    return face


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
