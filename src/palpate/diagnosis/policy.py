"""The settings of a search among explanations, each with its origin."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchPolicy:
    """How far a search goes; chosen for its time, not by the cases that are reported, where nothing else is said.

    Parameters
    ----------
    behind_best
        By how much the logarithm of the optimistic evidence may lie behind the best fit, once `least` are fitted.
    behind_adequate
        The same behind one that leaves only noise: more than twice that of a ratio of 100, within which explanations
        are accepted beside each other. Those within `behind_adequate` are compared on finer meshes: in a case of the
        blind trial the truth gained 6.5 there.
    behind_set
        The same of special cases behind an accepted set. A name too many is the worst error, and what follows to first
        order without one of the mechanisms is rough: in a case of the blind trial the truth seemed to lie 150 behind.
    least, most, most_sets
        Numbers of explanations that are fitted at least, and at most, with one mechanism and with several.
    mechanism_penalty
        By how much one more mechanism must raise the log-likelihood of the residual before that residual is taken as
        the noise of recordings without replicates: a parameter costs one by Akaike's criterion, about three by
        Schwarz's.
    trusted
        Chi-square per degree of freedom of an explanation up to which the optimistic evidence of larger ones is trusted
        before `least` are fitted.
    outside
        By how many of its ranges a parameter may lie outside before the explanation is fitted once more from within.
    threads
        Fits that run at once, each on a core; what is found does not depend on it.
    """

    behind_best: float = 40.0
    behind_adequate: float = 10.0
    behind_set: float = 400.0
    least: int = 5
    most: int = 8
    most_sets: int = 5
    mechanism_penalty: float = 2.0
    trusted: float = 3.0
    outside: float = 1.0
    threads: int = 1
