"""The settings of a search among explanations, each with its origin."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchPolicy:
    """How far a search goes; chosen for its time, not by the cases that are reported, where nothing else is said.

    Parameters
    ----------
    held
        Probability that the smallest group of sets of mechanisms holds, by which a verdict is given.
    negligible
        Probability of a set, relative to the likeliest, below which it is not refitted and counts to first order,
        unless it is one of the group that decides.
    negligible_if_safe
        The same where a refit can hardly change what is said: where the mechanism that joins only adds to the depth,
        whose evidence to first order is that of a refit within about one, and where the set contains the likeliest one,
        and so is no rival to it, in recordings without replicates, which identify nothing.
    rough
        Error of a log evidence to first order that is allowed for before a set counts as negligible, and by which a
        fit must lie behind its evidence to first order before it is searched for once more.
    near
        By how much a log evidence may lie behind the best one where a search that was given up goes on; replicates
        alone can identify what it finds.
    behind_set
        The same of special cases behind a set of several mechanisms. A name too many is the worst error, and what
        follows to first order without one of the mechanisms is rough: in a case of the blind trial the truth seemed to
        lie 150 behind.
    most, most_alone
        Number of explanations that are fitted at most, beside the base model; the second without replicates, which
        identify nothing.
    certain
        Inclusion of a family from which on it is identified.
    mechanism_penalty
        By how much one more mechanism must raise the log-likelihood of the residual before that residual is taken as
        the noise of recordings without replicates: a parameter costs one by Akaike's criterion, about three by
        Schwarz's.
    outside
        By how many of its ranges a parameter may lie outside before the explanation is fitted once more from within.
    threads
        Fits that run at once, each on a core; what is found does not depend on it.
    """

    held: float = 0.95
    negligible: float = 0.05
    negligible_if_safe: float = 0.3
    rough: float = 3.0
    near: float = 10.0
    behind_set: float = 400.0
    most: int = 16
    most_alone: int = 6
    certain: float = 0.99
    mechanism_penalty: float = 2.0
    outside: float = 1.0
    threads: int = 1
