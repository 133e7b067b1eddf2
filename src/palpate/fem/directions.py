"""How the inputs of the solver change with parameters, and what becomes of that in one time step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem.clock import Shift
from palpate.fem.profile import Capped, Profile
from palpate.fem.scalar_radial import HARDENING, STEADY, STEADY_EXPONENT, VOIGT, YIELD
from palpate.specimen import Specimen

SPHERE_EDGE = 0.99  # of its radius, beyond which a sphere continues flat, see `palpate.fem.profile.Capped`


@dataclass(frozen=True, eq=False)
class Directions:
    """Derivatives of the inputs of the solver with respect to p parameters.

    Parameters
    ----------
    coefficients : ndarray, shape (regions, c, p)
        Of the laws at large depth.
    slope, radius : ndarray, shape (p,)
        Of the profile's flank, and of its cap [um].
    friction : ndarray, shape (p,)
    size_length : ndarray, shape (p,)
        [nm]
    shifts : tuple of Shift
        Of the load history, one for each parameter that moves it.
    """

    coefficients: np.ndarray
    slope: np.ndarray
    radius: np.ndarray
    friction: np.ndarray
    size_length: np.ndarray
    shifts: tuple[Shift, ...]

    @property
    def count(self) -> int:
        """Number of parameters."""
        return len(self.slope)

    @property
    def moves_tip(self) -> bool:
        """Whether a parameter changes the profile of the indenter."""
        return bool(self.slope.any() or self.radius.any())


def profile_change(profile: Profile, directions: Directions, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the changes (k, p) of f and df/dr at the distances `r` (k,) [um]; a measured tip has nothing to change.

    On the cap f = R - sqrt(R^2 - r^2); on a flank of slope s, f = s r - R (sqrt(1 + s^2) - 1).
    """
    if not isinstance(profile, Capped):
        unchanged = np.zeros((len(r), directions.count))
        return unchanged, unchanged
    r, radius, slope = r[:, None], profile.radius, profile.slope
    edge = min(profile.junction, SPHERE_EDGE * radius)
    root = np.sqrt(radius**2 - np.clip(r, -edge, edge) ** 2) if radius > 0.0 else np.ones_like(r)
    if not np.isfinite(slope):
        slope = SPHERE_EDGE / np.sqrt(1.0 - SPHERE_EDGE**2)
    on_cap = r < edge
    stretch = np.hypot(1.0, slope)
    flank = (1.0 - stretch) * directions.radius + (r - radius * slope / stretch) * directions.slope
    height = np.where(on_cap, (1.0 - radius / root) * directions.radius, flank)
    inclination = np.where(on_cap, -radius * r / root**3 * directions.radius, directions.slope)
    return height, inclination


def change_beneath(
    profile: Profile, directions: Directions, r: np.ndarray, moved: np.ndarray, large: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return the changes (k, p) of f and df/dr as `palpate.fem.profile.Profile.beneath` gives them."""
    if large:
        return profile_change(profile, directions, r + moved)
    height, inclination = profile_change(profile, directions, r)
    return height + inclination * moved[:, None], inclination


def resisted_change(
    laws: np.ndarray, specimen: Specimen, directions: Directions, depth: float, d_depth: np.ndarray
) -> np.ndarray:
    """Return the changes (regions, c, p) of `palpate.specimen.resisted` laws at a `depth` [nm] that changes too."""
    d_laws = directions.coefficients
    length, floor = specimen.size_length, max(depth, specimen.shallowest)
    d_depth = d_depth if depth > floor * (1 - 1e-12) else np.zeros_like(d_depth)
    resistance = specimen.resistance(depth)
    d_resistance = (directions.size_length - length * d_depth / floor) / (2.0 * floor * resistance)
    if not d_resistance.any() and resistance == 1.0:
        return d_laws
    changed = d_laws.copy()
    flows = [(STEADY, STEADY_EXPONENT)] + [(k, k + 1) for k in range(VOIGT, laws.shape[1], 3)]
    for c, m in flows:
        power = 2.0 * laws[:, m, None] + 1.0
        relative = 2.0 * d_laws[:, m] * np.log(resistance) + power * d_resistance / resistance
        changed[:, c] = resistance**-power * (d_laws[:, c] - laws[:, c, None] * relative)
    for c in (YIELD, HARDENING):
        changed[:, c] = resistance * d_laws[:, c] + laws[:, c, None] * d_resistance
    return changed


def weights_change(coefficients: np.ndarray, d_coefficients: np.ndarray, dt: float, d_dt: np.ndarray) -> np.ndarray:
    """Return the changes (regions, w, p) of `palpate.fem.scalar_radial.step_weights`; the step `dt` changes too."""
    steady = 0.5 * (dt * d_coefficients[:, STEADY] + coefficients[:, STEADY, None] * d_dt)
    changes = [steady]
    for k in range(VOIGT, coefficients.shape[1], 3):
        amplitude, time = coefficients[:, k, None], coefficients[:, k + 2, None]
        d_amplitude, d_time = d_coefficients[:, k], d_coefficients[:, k + 2]
        x = dt / time
        d_x = (d_dt - x * d_time) / time
        decay, mean = np.exp(-x), -np.expm1(-x) / x
        d_decay, d_mean = -decay * d_x, (decay - mean) / x * d_x
        changes += [
            d_decay,
            (d_mean - d_decay) * amplitude + (mean - decay) * d_amplitude,
            (1.0 - mean) * d_amplitude - d_mean * amplitude,
            d_coefficients[:, k + 1],
        ]
    return np.stack(changes, axis=1)
