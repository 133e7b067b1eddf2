r"""The likelihood of uniaxial tests that calibrate: independent data beside the curves of indentation.

The response of a test, the stress or the strain that its machine did not prescribe, is

    y = f(theta) + delta + noise,        delta = S x,

with the law's response f at a point, white noise of the test's own standard deviation, and the largest response so far
S. The discrepancy x of the law is a Gaussian process of standard deviation `share`, which changes with the time t since
the beginning, and with the way w of what is prescribed, in units of its largest value,

    corr(x, x') = (1 + r) exp(-r),    r^2 = 3 ((ln t - ln t')^2 / a^2 + (w - w')^2 / b^2),

over the lengths that the depth's has. That is Matern's correlation, once differentiable: with the depth's, which is
infinitely smooth, the corners of one precise curve would ask for a size far above what the law lacks.

Its size is that which makes the residual of the law's best fit to this test alone most likely, with the prior of the
depth's: a depth goes with the root of a compliance, so that the median is twice `law_error`. So it is known before any
curve of indentation, and is the same for all explanations, whose evidence can be compared. What the law lacks here and
under the tip counts as independent.

Source: M. C. Kennedy and A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425-464, for the discrepancy; C. E. Rasmussen and
C. K. I. Williams, Gaussian Processes for Machine Learning (2006), equation 4.17, for the correlation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.stats import logistic

from palpate.data.bulk_tests import BulkTest
from palpate.inference.discrepancy import PRIOR_SCALE, SHARES
from palpate.inference.law_structure import HISTORIES, TIMES
from palpate.materials import law_of
from palpate.materials.flow.uniaxial import response_in_steps, steps_needed
from palpate.models.bulk_model import BulkModel
from palpate.models.coordinates import Coordinates

OF_COMPLIANCE = 2.0  # relative change of a compliance over that of a depth
NOT_BORNE = 1.0  # a strain: what counts as the response where no strain bears the stress
STARTS = 12  # places over the ranges, of which the best begins the fit to a test alone
ROUNDS = 3  # of parameters and size in turn
STEP = 1e-4  # of a range, over which the response is differenced
PRIOR_PRECISION = 12.0  # of a coordinate beforehand


@dataclass(frozen=True, eq=False)
class FittedTest:
    """A test that calibrates, and its errors.

    Parameters
    ----------
    test
    steps
        From a sample to the next.
    share
        Standard deviation of the law's discrepancy as a share of the largest response so far.
    """

    test: BulkTest
    steps: int
    share: float

    @cached_property
    def factor(self) -> np.ndarray:
        """Lower Cholesky factor (n, n) of the covariance of the errors."""
        return cholesky(covariance(self.test, self.share), lower=True)

    def residual(self, model: str, parameters: Mapping[str, float]) -> np.ndarray:
        """Return the response less the recorded one (n,), of a law with all parameters by name."""
        test, row = self.test, law_of(model).coefficients(parameters)
        response = response_in_steps(row, test.test.time, test.prescribed, test.control, self.steps)
        return np.where(np.isnan(response), NOT_BORNE, response) - test.response


@dataclass(frozen=True, eq=False)
class BulkLikelihood:
    """All tests that calibrate."""

    tests: tuple[FittedTest, ...] = ()

    @classmethod
    def of(cls, bulk: BulkModel, coordinates: Coordinates, law_error: float) -> BulkLikelihood:
        """Estimate the size of the law's discrepancy in each test; `law_error` is a share of the depth, 0 for none."""
        fitted = [test for test in bulk.tests if test.role == "calibrate"]
        return cls(tuple(_sized(bulk, test, coordinates, law_error) for test in fitted))

    def departures(self, model: str, parameters: Mapping[str, float]) -> np.ndarray:
        """Return the whitened residuals (m,) [standard deviations] of a law with all parameters by name."""
        white = [solve_triangular(each.factor, each.residual(model, parameters), lower=True) for each in self.tests]
        return np.concatenate(white) if white else np.empty(0)


def covariance(test: BulkTest, share: float) -> np.ndarray:
    """Return the covariance (n, n) of the errors of a test's response, with a discrepancy of a `share` of it."""
    time = test.test.time - test.test.time[0]
    logs = np.log(np.maximum(time, time[1]))
    largest = np.maximum.accumulate(np.abs(test.response))
    way = np.cumsum(np.abs(np.diff(test.prescribed, prepend=0.0))) / np.abs(test.prescribed).max()
    apart = np.sqrt(3.0 * (((logs[:, None] - logs) / TIMES) ** 2 + ((way[:, None] - way) / HISTORIES) ** 2))
    correlation = (1.0 + apart) * np.exp(-apart)
    return test.noise**2 * np.eye(len(time)) + share**2 * np.outer(largest, largest) * correlation


def _sized(bulk: BulkModel, test: BulkTest, coordinates: Coordinates, law_error: float) -> FittedTest:
    """Return a test with the likeliest size of the law's discrepancy, by a fit to it alone."""
    found, u = FittedTest(test, 1, OF_COMPLIANCE * law_error), np.full(len(coordinates.free), 0.5)
    for number in range(ROUNDS):
        u = _fitted_alone(bulk, found, coordinates, u, first=number == 0)
        row = law_of(bulk.model).coefficients({**bulk.fixed, **coordinates.named(u)})
        steps = steps_needed(row, test.test.time, test.prescribed, test.control)
        found = FittedTest(test, steps, _likeliest_share(bulk, found, coordinates, u, law_error))
    return found


def _fitted_alone(
    bulk: BulkModel, found: FittedTest, coordinates: Coordinates, u: np.ndarray, first: bool
) -> np.ndarray:
    """Return the coordinates (k,) of the law's best fit to a test alone, from some; the `first` from several places."""
    factor = found.factor

    def departures(u: np.ndarray) -> np.ndarray:
        residual = found.residual(bulk.model, {**bulk.fixed, **coordinates.named(u)})
        return np.append(solve_triangular(factor, residual, lower=True), coordinates.beyond(u))

    if first:
        places = [u, *np.random.default_rng(0).random((STARTS, len(u)))]
        u = min(places, key=lambda place: float(np.sum(departures(place) ** 2)))
    return np.asarray(least_squares(departures, u, diff_step=STEP, x_scale="jac").x)


def _likeliest_share(
    bulk: BulkModel, found: FittedTest, coordinates: Coordinates, u: np.ndarray, law_error: float
) -> float:
    """Return the likeliest size of the discrepancy at coordinates u (k,), the parameters integrated over."""
    if not law_error:
        return 0.0

    def residual(u: np.ndarray) -> np.ndarray:
        return found.residual(bulk.model, {**bulk.fixed, **coordinates.named(u)})

    steps = STEP * np.eye(len(u))
    slopes = np.stack([(residual(u + step) - residual(u - step)) / (2.0 * STEP) for step in steps], axis=1)
    columns, densities = np.column_stack([residual(u), slopes]), []
    for share in SHARES:
        factor = cholesky(covariance(found.test, share), lower=True)
        white = solve_triangular(factor, columns, lower=True)
        precision = white[:, 1:].T @ white[:, 1:] + PRIOR_PRECISION * np.eye(len(u))
        pull = white[:, 1:].T @ white[:, 0]
        squares = float(white[:, 0] @ white[:, 0] - pull @ np.linalg.solve(precision, pull))
        volume = 2.0 * np.log(np.diag(factor)).sum() + np.linalg.slogdet(precision)[1]
        prior = logistic.logpdf(np.log(share / (OF_COMPLIANCE * law_error)) / PRIOR_SCALE)
        densities.append(-0.5 * (squares + volume) + prior)
    return float(SHARES[int(np.argmax(densities))])
