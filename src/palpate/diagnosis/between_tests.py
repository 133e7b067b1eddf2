r"""Whether values that differ between recordings depend on the test: then something else was left out.

A drift or a zero point belongs to each single recording. If it is what was left out, its values scatter as much between
the replicates of one test as between tests. Physics outside the library can resemble it, with a value for each test;
but then the replicates of a test agree and the tests differ.

One-way analysis of variance (R.A. Fisher, Statistical Methods for Research Workers, 1925, ch. VII), on the values of
single recordings by generalised least squares. Less certain values have less weight, and the error of the simulation is
common to the replicates of a test, so the distribution of the ratio is found from draws: the variance between
replicates from its scaled inverse chi-square distribution, then the tests' means. Without an error of the simulation
and with equal precision this is Fisher's test.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from palpate.inference.explanation import Fit

DRAWS = 20000
JITTER = 1e-9  # of the variance of a value, added where the simulation is exact


def p_between_tests(fit: Fit, rng: np.random.Generator) -> dict[str, float]:
    """Return, for each amplitude ``key.name`` that varies, the p-value of tests differing no more than replicates do.

    Conditions with a single recording do not count, nor those in which an amplitude shows nothing; with fewer than two
    others there is nothing to compare, and no p-value.
    """
    problem = fit.problem
    if not fit.own:
        return {}
    columns = problem.split(np.column_stack([problem.unit_effects(amplitude) for amplitude in fit.own]))
    conditions = [k for k in problem.repeated if columns[problem.names[k]].any(axis=0).all()]
    if len(conditions) < 2:
        return {}
    of_tests = (_values_of_test(fit, k, columns[problem.names[k]]) for k in conditions)
    estimators, variances, values = zip(*of_tests, strict=True)
    places = problem.split(np.arange(len(fit.curve)))
    of = np.concatenate([places[problem.names[k]] for k in conditions])
    simulated = fit.errors.of_simulation[np.ix_(of, of)]
    found = {}
    for place, amplitude in enumerate(fit.own):
        every = block_diag(*(estimator[place] for estimator in estimators))
        rows, noise = ([each[place] for each in those] for those in (values, variances))
        found[str(amplitude)] = p_of_means(rows, np.array(noise), every @ simulated @ every.T, rng)
    return found


def _values_of_test(fit: Fit, number: int, design: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the values (k, r) in the recordings of a condition, about their means; a unit adds to the design (n, k).

    Before them stand the generalised-least-squares matrix (k, n) that maps depths to values, and their variances (k,)
    from the noise of a recording without the scatter of its own amplitudes.
    """
    noise, own = fit.errors.noise, [str(amplitude) for amplitude in fit.own]
    rest = {name: part for name, part in fit.errors.components[number].items() if name not in own}
    weighed = np.linalg.solve(noise.matrix(number, rest), design)
    spread = np.linalg.inv(design.T @ weighed)
    estimator = spread @ weighed.T
    name = fit.problem.names[number]
    departures = fit.problem.observed[name].response - fit.problem.split(fit.curve)[name]
    return estimator, np.diag(spread), estimator @ departures.T


def p_of_means(rows: list[np.ndarray], noise: np.ndarray, shared: np.ndarray, rng: np.random.Generator) -> float:
    """Return the p-value of the means of `rows` differing no more than replicates and the simulation's error explain.

    Parameters
    ----------
    rows : sequence of ndarray, shape (r,)
        Values of each test's recordings.
    noise : ndarray, shape (c,)
        Variance with which a recording of each test gives its value.
    shared : ndarray, shape (c, c)
        Covariance of what all recordings of a test have in common.
    rng
        Source of the draws.
    """
    counts = np.array([len(row) for row in rows])
    means = np.array([row.mean() for row in rows])
    squares = np.array([np.sum((row - row.mean()) ** 2) for row in rows])
    freedom = counts - 1
    natural = max(float(np.sum(squares - freedom * noise) / freedom.sum()), 0.0)
    scale = 1.0 / (natural + noise)
    within = float(np.sum(scale * squares) / freedom.sum())

    def between(means: np.ndarray) -> np.ndarray:
        weights = counts * scale
        return np.sum(weights * (means - (means @ weights / weights.sum())[..., None]) ** 2, axis=-1)

    variance = within * freedom.sum() / rng.chisquare(freedom.sum(), size=(DRAWS, 1))
    root = np.linalg.cholesky(shared + JITTER * np.diag(1.0 / scale))
    drawn = rng.standard_normal((DRAWS, len(rows))) * np.sqrt(variance / (scale * counts))
    drawn += rng.standard_normal((DRAWS, len(rows))) @ root.T
    return float((1.0 + np.sum(between(drawn) >= between(means))) / (1.0 + DRAWS))
