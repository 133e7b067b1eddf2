r"""How probable each contact on trial is, given a baseline that was learnt in the air.

The loads of a test, averaged over blocks, are

    P = B b + k L(h; h_0, m) + e,        e ~ N(0, s^2 C),

with a baseline and its noise (`palpate.recordings.baseline`), a law L of the contact (`palpate.recordings.contact_law`)
and

    C = noise of the load + (slope of the load x noise of the depth)^2 + (delta R)^2 exp(-|log x - log x'|),

where R is how far the load has risen for good and x the way from where it begins to. The last term is what no law
describes: a soft layer, a crack, a pop-in. It acts beyond the contact on trial only, and deep points count the less the
larger delta is. Coefficients b, k and the scale s are integrated out, laws and delta are averaged over.

Sources: M.C. Kennedy and A. O'Hagan, J. R. Stat. Soc. B 63 (2001) 425-464 (a law's discrepancy as a Gaussian process);
M. Plummer, Stat. Comput. 25 (2015) 37-43 (parts of a model that learn from some of the data only); P.D. Grunwald and
T. van Ommen, Bayesian Anal. 12 (2017) 1069-1103 (a tempered likelihood where every model is wrong).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import ndtr

from palpate.recordings.baseline import Baseline
from palpate.recordings.blocks import Blocks
from palpate.recordings.contact_law import LOG_PRIOR, loads_of_laws

TEMPER = 1.5  # by which log-likelihoods are divided, chosen: neighbouring blocks share what no law describes
DISCREPANCIES = (0.003, 0.03, 0.3, 1.0)  # delta on trial


@dataclass(frozen=True)
class Rise:
    """What is known of a load without any law.

    Attributes
    ----------
    risen : ndarray, shape (n,)
        By how much the load stands clear of the noise about its baseline for good: its least from a block on.
    slope_noise : ndarray, shape (n,)
        Slope of the load times the noise of the depth, of a point.
    """

    risen: np.ndarray
    slope_noise: np.ndarray


def log_posterior(blocks: Blocks, rise: Rise, baseline: Baseline, contacts: np.ndarray, white: float) -> np.ndarray:
    """Return the logarithm of the posterior density (k, deltas, laws) of contacts (k,), up to a constant.

    Parameters
    ----------
    blocks, rise
        What is explained; time, depth and load run over a unit.
    baseline
        Learnt in the air.
    contacts
        On trial.
    white
        Standard deviation of the white noise of a point.
    """
    size, depth = len(blocks), blocks.depth
    shared = baseline.noise.covariance(blocks, white) + np.diag(rise.slope_noise**2 / blocks.count)
    terms, spread = baseline.columns(blocks), baseline.deviations
    width = terms.shape[1]
    loads = loads_of_laws(depth, contacts, float(depth.max())).transpose(1, 0, 2)
    first = max(int(np.argmax(rise.risen > 0.0)) - 1, 0)
    far = np.log(np.maximum(np.maximum.accumulate(depth) - depth[first], 1e-6))
    process = np.outer(rise.risen, rise.risen) * np.exp(-np.abs(np.subtract.outer(far, far)))
    beyond = depth > contacts[:, None]
    process = np.where(beyond[:, :, None] & beyond[:, None, :], process, 0.0)
    known = np.column_stack([blocks.load, terms])
    columns = np.concatenate([np.broadcast_to(known, (len(contacts), *known.shape)), loads], axis=2)
    degrees, largest = size + baseline.count - 2, float(rise.risen.max())
    found = []
    for delta in DISCREPANCIES:
        factor = np.linalg.cholesky(shared + delta**2 * process)
        whitened = np.stack(
            [
                solve_triangular(each, column, lower=True, check_finite=False)
                for each, column in zip(factor, columns, strict=True)
            ]
        )
        load, term, law = whitened[:, :, :1], whitened[:, :, 1 : 1 + width], whitened[:, :, 1 + width :]
        inner = np.linalg.cholesky(term.transpose(0, 2, 1) @ term + np.diag(spread**-2.0))
        along_load, along_law = (np.linalg.solve(inner, term.transpose(0, 2, 1) @ part) for part in (load, law))
        of_load = np.sum(load**2, axis=1) - np.sum(along_load**2, axis=1)
        power = np.sum(law**2, axis=1)
        power = np.maximum(power - np.sum(along_law**2, axis=1), 1e-10 * power + 1e-12)
        mixed = np.sum(law * load, axis=1) - np.sum(along_law * along_load, axis=1)
        amplitude = mixed / power
        left = np.maximum(of_load - amplitude**2 * power, 1e-9 * of_load + 1e-12) + baseline.squares
        error = np.sqrt(left / degrees / power)
        within = ndtr((2 * largest - amplitude) / error) - ndtr((0.5 * largest - amplitude) / error)
        half = sum(np.log(np.diagonal(f, axis1=1, axis2=2)).sum(axis=1) for f in (factor, inner))
        score = -half[:, None] - 0.5 * degrees * np.log(left) - 0.5 * np.log(power)
        found.append(score + np.log(np.maximum(within, 1e-300)) + LOG_PRIOR)
    return np.stack(found, axis=1)


def weighed(posteriors: Sequence[np.ndarray], weights: Sequence[float]) -> np.ndarray:
    """Return the weights (k, deltas, laws) of a mixture of posteriors, each tempered and brought to a sum of one."""
    total = np.zeros_like(posteriors[0])
    for logarithm, weight in zip(posteriors, weights, strict=True):
        density = np.exp((logarithm - logarithm.max()) / TEMPER)
        total += weight * density / density.sum()
    return total
