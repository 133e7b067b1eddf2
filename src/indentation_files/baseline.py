r"""What the load reads while the tip is in air: a straight line, and what instruments lay over it.

A baseline is a sum of terms, each absent or present: offset, tilt in depth, drift in time, one wave (interference of
light, a slow oscillation of the support) in depth or in time, and the transient of a stage that starts. What is left
is noise, some of it correlated: white noise and an Ornstein-Uhlenbeck process, averaged over blocks of points.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

TIMES = (0.002, 0.005, 0.012, 0.03, 0.07, 0.16)  # of transients, as shares of the fit's duration
# Prior standard deviations of the coefficients, in ranges of the load; an offset is free, and zero is held.
DEVIATIONS = {"zero": 1e-6, "offset": 1e3, "tilt": 0.5, "drift": 0.5, "cosine": 0.05, "sine": 0.05, "transient": 0.2}
MOST_CYCLES = 60.0  # of a wave over the points before contact
FOR_OFFSET, FOR_SLOPE, FOR_CURVE = 3, 6, 30  # points in air, chosen
BESIDE = (-0.2, -0.1, -0.05, 0.0, 0.05, 0.1, 0.2)  # cycles over the span, about the frequency found
Term = tuple[str, float]
ZERO: Term = ("zero", 0.0)
OFFSET: Term = ("offset", 0.0)
STRAIGHT: tuple[tuple[Term, ...], ...] = ((), (("tilt", 0.0),), (("drift", 0.0),), (("tilt", 0.0), ("drift", 0.0)))


@dataclass(frozen=True)
class Baselines:
    """Baselines on trial.

    `waves` are waves on trial: ``depth`` or ``time``, and cycles over a unit of it. Of the points before contact,
    `in_air`, an offset needs three, a slope six, a wave or a transient thirty. Drift and tilt are tried `together` too,
    which is the whole load of a spring in series driven evenly, unless that is excluded.
    """

    waves: tuple[tuple[str, float], ...] = ()
    in_air: int = 0
    together: bool = True

    def combinations(self) -> Iterator[tuple[Term, ...]]:
        """Yield every baseline as its terms."""
        if self.in_air < FOR_OFFSET:
            yield (ZERO,)
            return
        sloped = STRAIGHT if self.together else STRAIGHT[:-1]
        straight = sloped if self.in_air >= FOR_SLOPE else STRAIGHT[:1]
        waves: list[tuple[Term, ...]] = [()]
        starts: list[tuple[Term, ...]] = [()]
        if self.in_air >= FOR_CURVE:
            waves += [(("cosine " + axis, f), ("sine " + axis, f)) for axis, f in self.waves]
            starts += [(("transient", a), ("transient", b)) for a, b in pairwise(TIMES)]
        for slope, wave, start in product(straight, waves, starts):
            yield (OFFSET, *slope, *wave, *start)

    def log_prior(self, terms: tuple[Term, ...]) -> float:
        """Return the logarithm of a baseline's prior weight: each kind of term is absent or present alike."""
        kinds = {name.split()[0] for name, _ in terms}
        of_wave = np.log(max(len(self.waves), 1)) if "sine" in kinds else 0.0
        of_start = np.log(len(TIMES) - 1) if "transient" in kinds else 0.0
        return -float(np.log(16.0) + of_wave + of_start)


def values(term: Term, time: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return a term (n,) over times and depths (n,) that run over a unit."""
    name, number = term
    if name in ("zero", "offset"):
        return np.ones_like(time)
    if name in ("tilt", "drift"):
        along = depth if name == "tilt" else time
        return along - along.mean()
    if name == "transient":
        return np.exp(-(time - time[0]) / number)
    wave, axis = name.split()
    phase = 2 * np.pi * number * (depth if axis == "depth" else time)
    return np.cos(phase) if wave == "cosine" else np.sin(phase)


def waves_in(
    residual: np.ndarray, weight: np.ndarray, time: np.ndarray, depth: np.ndarray
) -> tuple[tuple[str, float], ...]:
    """Return the strongest wave in the residual of a fit, in depth and in time, with neighbouring frequencies.

    A least-squares periodogram (N.R. Lomb, Astrophys. Space Sci. 39 (1976) 447-462) beside a straight line, of a
    `residual` (n,) over `time` [s] and `depth` [nm], each (n,); the `weight` (n,) is one over the standard deviation of
    each point.
    """
    found: list[tuple[str, float]] = []
    for axis, along in (("depth", depth), ("time", time)):
        span = float(np.ptp(along))
        if len(residual) < 12 or span <= 0:
            continue
        straight = np.linalg.qr(weight[:, None] * np.column_stack([np.ones_like(along), along]))[0]
        frequency = np.arange(0.5, min(MOST_CYCLES, len(residual) / 3), 0.1) / span
        phase = 2 * np.pi * along[:, None] * frequency
        cosine, sine = (_orthogonal(straight, weight[:, None] * wave(phase)) for wave in (np.cos, np.sin))
        projected = _orthogonal(straight, (weight * residual)[:, None])[:, 0]
        cc, ss, cs = (np.sum(a * b, axis=0) for a, b in ((cosine, cosine), (sine, sine), (cosine, sine)))
        c, s = projected @ cosine, projected @ sine
        power = (c**2 * ss + s**2 * cc - 2 * c * s * cs) / np.maximum(cc * ss - cs**2, 1e-12 * cc * ss)
        best = frequency[int(np.argmax(power))]
        found += [(axis, best + step / span) for step in BESIDE]
    return tuple(found)


def _orthogonal(basis: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return columns (n, k) less their part along an orthonormal basis (n, p)."""
    return columns - basis @ (basis.T @ columns)


def correlated(begin: np.ndarray, end: np.ndarray, time: float) -> np.ndarray:
    r"""Return the covariance (n, n) of averages of an Ornstein-Uhlenbeck process over blocks from `begin` to `end`.

    The process has unit variance and the correlation :math:`e^{-|t - t'| / \tau}`; its averages follow by integration.
    """
    length = np.maximum((end - begin) / time, 1e-6)
    mean = -np.expm1(-length) / length
    gap = np.maximum(begin[None, :] - end[:, None], begin[:, None] - end[None, :]) / time
    found = np.exp(-np.maximum(gap, 0.0)) * np.outer(mean, mean)
    found[np.diag_indices(len(length))] = 2 * (length - 1 + np.exp(-length)) / length**2
    return found
