"""The settings of a search among explanations, each with its origin."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchPolicy:
    """How far a search goes; chosen for its time, not by the cases that are reported, where nothing else is said.

    Parameters
    ----------
    starts
        Number of amplitudes from which the fit of a mechanism with several quantities starts; with one quantity, the
        best is enough. The searches advance together, and one that falls behind is given up.
    iterations
        Largest number of iterations of a search; those that converge take 4 to 8, and 1 to 3 where one ended before.
    first_tolerance, tolerance
        Changes of chi-square below which a search has converged: 0.7 and 0.14 standard deviations of the whole
        estimate.
    poor_fit
        Chi-square per sample above which a fit leaves far more than noise, whatever the error of the mesh: it is not
        refined.
    behind_best
        By how much the optimistic log evidence may lie behind the best fit, once `least` explanations are fitted.
    behind_adequate
        The same behind an adequate fit: more than twice log 100, the distance within which both are accepted.
    least, most, most_sets
        Numbers of explanations that are fitted at least, and at most, with one mechanism and with several.
    mechanism_penalty
        By how much one more mechanism must raise the log-likelihood of the residual before that residual is taken as
        the noise of recordings without replicates: a parameter costs one by Akaike's criterion, about three by
        Schwarz's.
    """

    starts: int = 2
    iterations: int = 12
    first_tolerance: float = 0.5
    tolerance: float = 0.02
    poor_fit: float = 50.0
    behind_best: float = 40.0
    behind_adequate: float = 10.0
    least: int = 5
    most: int = 8
    most_sets: int = 5
    mechanism_penalty: float = 2.0
