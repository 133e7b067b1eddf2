r"""Detection: whether an explanation leaves anything but noise.

The whitened residual is projected off the tangent space of the fitted parameters. Three kinds of filters are then
applied to it:

    signatures   each mechanism's effect at several amplitudes (`screen`), one degree of freedom each
    own values   a mechanism that varies, with a value for each condition, as many degrees of freedom
    polynomials  1, x, x^2 over each segment of each condition, three degrees of freedom

each turned into a chi-square probability; the smallest one is the statistic. Its distribution comes from simulated
noise: the noise model itself is drawn anew each time from its uncertainty, and the material parameters are refitted
(which, to first order, is the projection). So the p-value is for the whole family of filters. In the tangent space
itself the residual vanishes once the fit has converged within its bounds; what remains where it has not is tested by
its chi-square.

Two more kinds of tests use the single recordings: whether replicates differ as a mechanism with varying values makes
them, and whether the values of a mechanism in the explanation depend on the test (`between_tests`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from scipy.linalg import cholesky
from scipy.stats import chi2

from palpate.base.orthonormal import orthonormal
from palpate.diagnosis.between_tests import p_between_tests
from palpate.diagnosis.parts import polynomials
from palpate.diagnosis.screen import Screen
from palpate.inference.covariance import noise_of
from palpate.inference.explanation import Fit
from palpate.mechanisms import MECHANISMS
from palpate.study.prescribed_segments import segments

LEAST = 1e-3  # part of a filter outside the tangent space, below which it shows nothing
ENOUGH = 25  # draws as extreme as what was found, with which a p-value is known well enough
LONGEST = 10  # times as many draws as at once, at most
LEAST_LOG_P = -700.0  # where a probability underflows
REGULAR = 1e-9  # of the largest variance and 1 nm^2, added to each: a covariance of few common factors is singular


def log_p(basis: np.ndarray, white: np.ndarray) -> np.ndarray:
    """Return the logarithm of the chi-square probability of whitened residuals (n_all, m) in a filter's basis."""
    return chi2.logsf(np.sum((basis.T @ white) ** 2, axis=0), basis.shape[1])


def filters(fit: Fit, screen: Screen) -> list[np.ndarray]:
    """Return all filters: those of the mechanisms that were screened, and polynomials.

    Each is a basis (n_all, k) of directions of the residual in which an effect might be left, orthonormal in the
    whitened space and off the tangent space.
    """
    columns = [columns for _, _, columns in polynomials(fit.problem, segments)]
    for key in [key for key in screen.keys if key not in fit.explanation]:
        columns += [*screen.effects[key][:, :, None]]
        if MECHANISMS[key].varies:
            columns.append(fit.problem.effects_by_test(key))
    found = [orthonormal(fit.whiten(each), fit.tangent_space, LEAST) for each in columns]
    return [basis for basis in found if basis.shape[1]]


def simulated_noise(fit: Fit, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return whitened noise of the mean curves (n_all, count), the noise model drawn anew for each column."""
    shared = fit.errors.shared
    regular = shared + REGULAR * (1.0 + shared.diagonal().max()) * np.eye(len(shared))
    columns = cholesky(regular, lower=True) @ rng.standard_normal((len(shared), count))
    noise = fit.errors.noise.simulated(fit.errors.components, count, rng)
    means = [part / np.sqrt(n) for part, n in zip(noise, fit.errors.counts, strict=True)]
    return fit.whiten(columns + np.concatenate(means))


def examine(fit: Fit, screen: Screen, rng: np.random.Generator, draws: int, site_scatter: float) -> float:
    """Return the p-value of the hypothesis that the residual of `fit` is noise, for the whole family of tests.

    Parameters
    ----------
    fit, screen
        Fit whose residual is tested, and the effects of the mechanisms considered.
    rng, draws
        Source of the draws of the noise, and how many are made at once, see `monte_carlo_p`.
    site_scatter
        Assumed scatter of the depth between sites [-], where at most half of the conditions are repeated.
    """
    family = filters(fit, screen)
    found = max(min(float(log_p(basis, fit.white[:, None])[0]) for basis in family), LEAST_LOG_P)

    def as_extreme() -> int:
        noise = simulated_noise(fit, draws, rng)
        return int(np.sum(np.min([log_p(basis, noise) for basis in family], axis=0) <= found))

    p_means = monte_carlo_p(as_extreme, draws)
    unconverged = fit.tangent_space.T @ fit.white
    p_means = min(p_means, float(chi2.sf(unconverged @ unconverged, len(unconverged))))
    of_tests = list(p_between_tests(fit, rng).values())
    return combined([[p_means], between_replicates(fit, screen.keys, site_scatter), of_tests])


def monte_carlo_p(as_extreme: Callable[[], int], draws: int) -> float:
    """Return a p-value by sequential Monte Carlo: draws follow until `ENOUGH` of them are as extreme as what was found.

    The relative error of a p-value is then a fifth, whether it is 0.5 or 0.005. Where none of the first draws is as
    extreme, or `LONGEST` times as many draws have been made, no more are made.

    `as_extreme` makes so many `draws` at once, and returns how many of them are as extreme.

    Source: J. Besag and P. Clifford, Biometrika 78 (1991) 301-304.
    """
    extreme = made = 0
    while made < LONGEST * draws and (made == 0 or 0 < extreme < ENOUGH):
        extreme, made = extreme + as_extreme(), made + draws
    return (extreme + 1.0) / (made + 1.0)


def between_replicates(fit: Fit, keys: Iterable[str], site_scatter: float) -> list[float]:
    """Return p-values for amplitudes that vary between replicates: likelihood ratios with the variances at their bound.

    The ratio of one variance is chi-square of one degree of freedom or, as often, zero; that of k is a mixture, and no
    mixture exceeds a value more often than one of k - 1 and of k degrees, half each. A mechanism of the explanation,
    and one whose amplitudes have the effects of those, is left out.

    Source: S.G. Self and K.-Y. Liang, J. Am. Stat. Assoc. 82 (1987) 605-610, case 5.
    """
    if not fit.errors.noise.replicated:
        return []
    problem, found = fit.problem, []
    present = [problem.unit_effects(amplitude) for amplitude in fit.own]
    usual = noise_of(problem, fit.own, fit.residual, site_scatter)
    for key in [key for key in keys if MECHANISMS[key].varies and key not in fit.explanation]:
        columns = {amplitude: problem.unit_effects(amplitude) for amplitude in problem.typical(key)}
        more = [a for a, column in columns.items() if not any(np.allclose(column, other) for other in present)]
        if more:
            wider = noise_of(problem, tuple(sorted((*fit.own, *more))), fit.residual, site_scatter)
            ratio = 2.0 * max(wider.log_likelihood - usual.log_likelihood, 0.0)
            fewer = float(chi2.sf(ratio, len(more) - 1)) if len(more) > 1 else 0.0
            found.append(0.5 * (fewer + float(chi2.sf(ratio, len(more)))))
    return found


def combined(kinds: Iterable[Sequence[float]]) -> float:
    """Return the p-value of all tests together (Bonferroni), with equal weight for each kind that was made."""
    made = [p_values for p_values in kinds if p_values]
    return float(min(1.0, len(made) * min(len(p_values) * min(p_values) for p_values in made)))
