"""The estimate on the finite elements: from the surrogates' optimum and other places to the least misfit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_triangular
from scipy.stats import qmc

from palpate.errors import PalpateError
from palpate.inference.coordinates import Coordinates
from palpate.inference.forward import Curves, Forward
from palpate.inference.least_squares import Misfit
from palpate.inference.observation import Observation
from palpate.inference.recording_noise import Noise, model_covariance
from palpate.inference.trust_region import Descent, descend, resumed

SCATTERED = 16  # places of the ranges that are tried beside the surrogates' optima
SEARCHES = 2  # that go on, from the best of them
MAPPINGS = 3  # times that the model of record is simulated at most, each where the last search ended
ON_THE_WAY, AT_LAST = 30, 6  # largest numbers of iterations, with few samples and with all


@dataclass(frozen=True, eq=False)
class Linearised:
    """The least-squares problem around an estimate.

    Parameters
    ----------
    measured
        Mean curve (n_points,) of each condition.
    covariance : ndarray, shape (n, n)
        Of all means, one condition after the other.
    curves, slopes
        Simulated at the estimate, and their derivatives (n_points, k) by its coordinates.
    coordinates
    """

    measured: Mapping[str, np.ndarray]
    covariance: np.ndarray
    curves: Curves
    slopes: Curves
    coordinates: Coordinates

    def residual(self, u: np.ndarray) -> np.ndarray:
        """Whitened residuals at the estimate."""
        return self.whiten({name: self.curves[name] - recorded for name, recorded in self.measured.items()})

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Slope (n_residuals, k) of `residual`."""
        return self.whiten(self.slopes)

    @cached_property
    def factor(self) -> np.ndarray:
        """Lower Cholesky factor of the covariance."""
        return cholesky(self.covariance, lower=True)

    def whiten(self, parts: Mapping[str, np.ndarray]) -> np.ndarray:
        """L^-1 applied to a vector or matrix for each condition, stacked."""
        return solve_triangular(self.factor, np.concatenate([parts[name] for name in self.measured]), lower=True)

    def at_bound(self, u: np.ndarray) -> np.ndarray:
        """Return which coordinates (k,) lie on a limit of the law."""
        return self.coordinates.at_wall(u)


def all_errors(
    observations: Mapping[str, Observation], noise: Mapping[str, Noise], curves: Curves, solver_error: float
) -> np.ndarray:
    """Return the covariance (n, n) of the mean curves about simulated `curves`: noise, sites, error of the solver."""
    blocks = (noise[name].mean_covariance(curves[name], len(item.response)) for name, item in observations.items())
    shares = {name: item.quantity.share for name, item in observations.items()}
    return block_diag(*blocks) + model_covariance(curves, solver_error, shares)


def known_errors(
    observations: Mapping[str, Observation], noise: Mapping[str, Noise], curves: Curves, solver_error: float
) -> np.ndarray:
    """Return the covariance (n, n) of what is known to be no misfit: replicates' noise, sites, error of the solver.

    The noise of a condition that was tested once is not known apart from what the model lacks.
    """
    known = {
        name: noise[name] if len(item.response) > 1 else replace(noise[name], sigma=0.0)
        for name, item in observations.items()
    }
    return all_errors(observations, known, curves, solver_error)


def estimated(
    forward: Forward,
    observations: Mapping[str, Observation],
    known: np.ndarray,
    starts: Sequence[Mapping[str, float]],
    rng: np.random.Generator,
    report: Callable[[str], None],
) -> tuple[Descent, Forward]:
    """Return the least misfit of the forward model of record to the mean curves, and that model.

    The best of the `starts` and of some places scattered over the ranges are followed with few samples, the end of the
    better search with all, by the model of record.

    Parameters
    ----------
    known : ndarray, shape (n, n)
        Covariance of the errors that are known.
    starts
        Parameters by name.
    rng
        Scatters places.

    Raises
    ------
    PalpateError
        When the forward model fails at all starts.
    """
    coordinates = forward.coordinates
    measured = {name: item.mean for name, item in observations.items()}
    nm = {name: item.quantity.nm for name, item in observations.items()}
    cheaper, keep = forward.thinned()
    kept = np.concatenate([keep[name] for name in measured])
    fewer = {name: curve[keep[name]] for name, curve in measured.items()}
    misfit = Misfit(fewer, known[np.ix_(kept, kept)], nm, coordinates)
    scattered = qmc.Sobol(len(coordinates.free), seed=rng).random(SCATTERED)
    points = [np.maximum(coordinates.scaled(start), -1.0) for start in starts] + list(scattered)
    outcomes = cheaper.curves(points)
    residuals = [np.inf if isinstance(o, str) else float(np.sum(misfit.residual(o) ** 2)) for o in outcomes]
    chosen = [points[k] for k in np.argsort(residuals, kind="stable")[:SEARCHES] if np.isfinite(residuals[k])]
    if not chosen:
        raise PalpateError(f"the finite elements fail wherever a search may begin: {outcomes[0]}")
    way = descend(misfit, cheaper, chosen, ON_THE_WAY, report, exact=False)
    whole, recorded = Misfit(measured, known, nm, coordinates), forward.of_record(way.u)
    end = resumed(whole, recorded, way, AT_LAST, report)
    for _ in range(MAPPINGS - 1):
        again = recorded.of_record(end.u)
        if again is recorded:
            break
        recorded, end = again, resumed(whole, again, end, AT_LAST, report)
    return end, recorded


def estimated_anew(
    recorded: Forward,
    observations: Mapping[str, Observation],
    known: np.ndarray,
    earlier: Descent,
    report: Callable[[str], None],
) -> Descent:
    """Return the least misfit of the model of record to mean curves that have moved a little since an `earlier` one."""
    nm = {name: item.quantity.nm for name, item in observations.items()}
    misfit = Misfit({name: item.mean for name, item in observations.items()}, known, nm, recorded.coordinates)
    return resumed(misfit, recorded, earlier, AT_LAST, report)
