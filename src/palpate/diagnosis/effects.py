"""What each mechanism does to a curve: one surrogate over material and amplitude for each mechanism and condition.

The surrogate holds the difference between the curves with and without the mechanism, in which most of the mesh's error
cancels; where a good part of the effect can be derived from the curve without it, only the rest. The differences of
several mechanisms are added; the forward model itself has the last word (`refine`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate import snapshots
from palpate.config import Condition, Study
from palpate.diagnosis.design import PAIRS_FOR_EACH, Pair, candidates, pairs, refinement, thinned
from palpate.errors import PalpateError
from palpate.mechanisms import Mechanism
from palpate.surrogate import PODRBF

NO_DEPTH = 1e-6  # of the largest depth: below it an elastic body is unloaded


@dataclass(frozen=True, eq=False)
class Effects:
    """What a diagnosis knows about one condition beyond the base model's surrogate.

    Attributes
    ----------
    mechanisms
        Effects that were learnt, by key.
    refinement : ndarray, shape (n_points,)
        Depth on the fine mesh over that on the study's, for the middle material.
    middle : ndarray, shape (n_points,)
        Depth for the middle material on the study's mesh [nm].
    """

    mechanisms: Mapping[str, Effect]
    refinement: np.ndarray
    middle: np.ndarray


@dataclass(frozen=True, eq=False)
class Effect:
    """The effect of one mechanism under one condition.

    Attributes
    ----------
    surrogate
        From free material parameters and search coordinates (n, p + k) to the difference at the thinned times [nm], or
        [mN] where the load answers.
    spread : ndarray, shape (n_points, n_thinned)
        Linear interpolation from the thinned to all sample times.
    error : ndarray, shape (n_pairs, n_points)
        Leave-one-out errors [nm].
    unresolved : ndarray, shape (n_pairs, n_points)
        What interpolation in time is expected to miss [nm].
    failures
        Number of pairs that could not be simulated.
    """

    surrogate: PODRBF
    spread: np.ndarray
    error: np.ndarray
    unresolved: np.ndarray
    failures: int

    def predict(self, points: np.ndarray) -> np.ndarray:
        """Return the difference (n, n_points) [nm] at points (n, p + k)."""
        return self.surrogate.evaluate(points) @ self.spread.T


def interpolation(coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Return the matrix (n_fine, n_coarse) of linear interpolation in time, from zero at zero."""
    knots = np.concatenate([[0.0], coarse])
    return np.column_stack([np.interp(fine, knots, row) for row in np.eye(len(knots))[1:]])


def missed_between(coarse: np.ndarray, fine: np.ndarray, curves: np.ndarray) -> np.ndarray:
    """Estimate what linear interpolation of `curves` (m, n_coarse) to the fine times misses (m, n_fine).

    Half of what it misses at each coarse time when every other one is left out, as the steps are half as long (a
    quarter where the curve is smooth); largest in the middle between coarse times, nothing at them.
    """
    missed = np.zeros_like(curves)
    for first in (0, 1):
        kept = np.arange(len(coarse)) % 2 == first
        kept[-1] = True
        again = curves[:, kept] @ interpolation(coarse[kept], coarse).T
        missed[:, ~kept] = (curves - again)[:, ~kept]
    missed[:, -1] = missed[:, -2]
    after = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    place = np.clip((fine - coarse[after - 1]) / (coarse[after] - coarse[after - 1]), 0.0, 1.0)
    return 0.5 * (missed @ interpolation(coarse, fine).T) * 4.0 * place * (1.0 - place)


def fit_effects(study: Study, condition: Condition, folder: str | Path) -> Effects:
    """Fit the effects of all mechanisms that act on the body, under one condition, to the simulations in `folder`.

    Raises
    ------
    PalpateError
        When most simulations of a mechanism failed, there are fewer than three for each parameter, or the middle
        material could not be simulated.
    """
    times = thinned(condition.protocol).sample_time
    spread = interpolation(times, condition.protocol.sample_time)

    def curve(snapshot: snapshots.Snapshot) -> np.ndarray:
        content = snapshots.read(Path(folder) / f"{snapshot.address}.npz")
        return np.asarray(content[content["quantity"]])

    def rest(pair: Pair, mechanism: Mechanism) -> np.ndarray:
        protocol, values = pair.plain.specification.protocol, pair.acting.specification.mechanisms[mechanism.key]
        plain = curve(pair.plain)
        if mechanism.derived_under(protocol.control):
            plain = mechanism.on_curve(protocol.sample_time, protocol.sample_drive, plain, values)
        return curve(pair.acting) - plain

    usual, fine = (curve(snapshot) for snapshot in refinement(study, condition))
    if not np.isfinite([usual, fine]).all():
        raise PalpateError(f"the middle material could not be simulated under {condition.name}")
    fitted = {}
    for key, mechanism in candidates(study).items():
        found = pairs(study, condition, key)
        if not found:
            continue
        points = np.array([[*(p.cell[name] for name in study.free_parameters), *p.coordinates] for p in found])
        difference = np.array([rest(pair, mechanism) for pair in found])
        good = np.isfinite(difference).all(axis=1)
        if good.sum() < max(PAIRS_FOR_EACH * points.shape[1], len(good) // 2):
            raise PalpateError(
                f"{key} under {condition.name}: {good.sum()} of {len(good)} pairs succeeded, too few for "
                f"{points.shape[1]} parameters"
            )
        surrogate = PODRBF(kernel="multiquadric", shape="loo_each").fit(points[good], difference[good])
        unresolved = missed_between(times, condition.protocol.sample_time, difference[good])
        fitted[key] = Effect(surrogate, spread, surrogate.loo_error_ @ spread.T, unresolved, int((~good).sum()))
    return Effects(fitted, depth_ratio(fine, usual), usual)


def depth_ratio(depth: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return one depth curve (n,) over another [nm]; one where the other has come out of the body again."""
    deep = np.abs(other) > NO_DEPTH * np.abs(other).max()
    return np.divide(depth, other, out=np.ones_like(depth), where=deep)


def summary(effects: Effects) -> dict[str, dict[str, float]]:
    """Return the leave-one-out error and the failures of each effect."""
    return {
        key: {"loo_rmse_nm": float(np.sqrt(np.mean(e.error**2))), "pairs": len(e.error), "failures": e.failures}
        for key, e in effects.mechanisms.items()
    }
