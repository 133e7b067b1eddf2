"""Explanations of one set of recordings with their probabilities, over all sets of mechanisms that may act together.

A set has the evidence of its fit, or one to first order where it is not worth a fit, and a prior: the number of effects
is beta-binomial with as much probability for none as for all others together, and sets of one size are equally
probable. The sets are an odds table, so all of them share one sum, the empty set among them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import logsumexp
from scipy.stats import betabinom

from palpate.diagnosis.search import Candidate
from palpate.inference.problem import Explanation
from palpate.mechanisms import MECHANISMS

Members = frozenset[str]


def log_prior(number: int, considered: int) -> float:
    """Return the logarithm of the prior probability of one set of some `number` of the mechanisms considered."""
    if considered == 0:
        return 0.0
    return float(betabinom.logpmf(number, considered, 1, considered)) - math.log(math.comb(considered, number))


@dataclass(eq=False)
class Explanations:
    """The sets of mechanisms that were fitted or estimated.

    Attributes
    ----------
    considered
        Number of mechanisms.
    fitted
        The best fit of each set, by its mechanisms.
    estimated
        Of sets that were not fitted the smaller set from which they were estimated, and what the mechanism that joins
        adds to its log evidence to first order.
    on_finer_meshes
        What finer meshes change in the log evidence of a fitted set: of those that were finished, and as expected of
        others.
    """

    considered: int
    fitted: dict[Members, Candidate] = field(default_factory=dict)
    estimated: dict[Members, tuple[Members, float]] = field(default_factory=dict)
    on_finer_meshes: dict[Members, float] = field(default_factory=dict)
    finished: set[Members] = field(default_factory=set)

    def add(self, candidate: Candidate) -> None:
        """Add a fit; of one set the likeliest counts, and one that an exact law contradicts does not."""
        members = frozenset(candidate.fit.explanation)
        self.estimated.pop(members, None)
        if members in self.fitted and self.fitted[members].rank >= candidate.rank:
            return
        self.fitted[members] = candidate

    def estimate(self, members: Members, smaller: Members, gain: float) -> None:
        """Add what a set gains over a fitted smaller one to first order; the likeliest of several estimates counts."""
        if members in self.fitted:
            return
        before = self.estimated.get(members)
        if before is None or self.fitted[smaller].fit.log_evidence + gain > self._estimate(*before):
            self.estimated[members] = smaller, gain

    def finish(self, members: Members, candidate: Candidate) -> None:
        """Put the end of a fit on finer meshes in its place."""
        self.on_finer_meshes[members] = candidate.fit.log_evidence - self.fitted[members].fit.log_evidence
        self.fitted[members] = candidate
        self.finished.add(members)

    def follow_change(self, members: Members) -> bool:
        """Let a set take over the change of its largest part that is finished; return whether there is one."""
        parts = [each for each in self.finished if each < members]
        if parts:
            self.on_finer_meshes[members] = self.on_finer_meshes[max(parts, key=len)]
        return bool(parts)

    def _evidence(self, members: Members) -> float:
        """Return the log evidence of a fitted set, on finer meshes as far as that is known."""
        expected = 0.0 if members in self.finished else self.on_finer_meshes.get(members, 0.0)
        return self.fitted[members].fit.log_evidence + expected

    def _estimate(self, smaller: Members, gain: float) -> float:
        return self._evidence(smaller) + gain

    def log_weight(self, members: Members) -> float:
        """Return the logarithm of evidence times prior of a set."""
        if members in self.fitted:
            candidate = self.fitted[members]
            found = -np.inf if candidate.contradicts else self._evidence(members)
        else:
            found = self._estimate(*self.estimated[members])
        return found + log_prior(len(members), self.considered)

    def probabilities(self) -> dict[Members, float]:
        """Return the probability of every set, the likeliest first.

        A set with a mechanism that includes a special case is no rival to the same set with that special case, unless
        it is far likelier: its probability counts for the simpler one where that is not excluded.
        """
        weights = {members: self.log_weight(members) for members in [*self.fitted, *self.estimated]}
        total = logsumexp(list(weights.values()))
        found = {members: float(np.exp(weight - total)) for members, weight in weights.items()}
        for members in sorted(found, key=lambda each: -found[each]):
            for simpler in special_cases(members):
                if found.get(simpler, 0.0) > NOT_EXCLUDED * found[members]:
                    found[simpler] += found.pop(members)
                    break
        return dict(sorted(found.items(), key=lambda each: -each[1]))


NOT_EXCLUDED = 0.05  # probability of a special case, relative to its general form, from which on it is not excluded


def special_cases(members: Members) -> list[Members]:
    """Return the sets of as many mechanisms in which one has made place for a mechanism that it includes."""
    return [
        members - {key} | {included}
        for key in sorted(members)
        for included in MECHANISMS[key].includes
        if included not in members
    ]


def may_act_together(explanation: Explanation, key: str) -> bool:
    """Return whether no mechanism of an explanation includes another one, or is included by it."""
    return not any(
        key == other or key in MECHANISMS[other].includes or other in MECHANISMS[key].includes for other in explanation
    )


def acting(probabilities: Mapping[Members, float], acts: Mapping[Members, Mapping[str, float]]) -> dict[Members, float]:
    """Return the probability of each set that its mechanisms, and no others, act by more than the smallest effect.

    Parameters
    ----------
    probabilities
        Of all sets.
    acts
        Of each set the probability that its mechanisms act by more than that; one where not given.
    """
    found: dict[Members, float] = {}
    for members, probability in probabilities.items():
        each = {key: acts.get(members, {}).get(key, 1.0) for key in members}
        for number in range(len(members) + 1):
            for of_it in itertools.combinations(sorted(members), number):
                share = math.prod(each[key] if key in of_it else 1.0 - each[key] for key in members)
                found[frozenset(of_it)] = found.get(frozenset(of_it), 0.0) + probability * share
    return dict(sorted(found.items(), key=lambda each: -each[1]))


def smallest_group(probabilities: Mapping[Members, float], held: float) -> list[Members]:
    """Return the smallest group of sets that holds a probability, the likeliest first."""
    found, sum_of = list[Members](), 0.0
    for members in sorted(probabilities, key=lambda each: -probabilities[each]):
        found.append(members)
        sum_of += probabilities[members]
        if sum_of >= held:
            break
    return found


def simplest(group: Sequence[Members]) -> list[Members]:
    """Return the sets of a group that contain no other one of it."""
    return [members for members in group if not any(other < members for other in group)]


def inclusion(probabilities: Mapping[Members, float]) -> dict[str, float]:
    """Return the probability of each mechanism that it acts, over all sets."""
    found: dict[str, float] = {}
    for members, probability in probabilities.items():
        for key in members:
            found[key] = found.get(key, 0.0) + probability
    return found


def family_inclusion(probabilities: Mapping[Members, float]) -> dict[str, float]:
    """Return the probability of each family that one of its mechanisms acts, over all sets."""
    found: dict[str, float] = {}
    for members, probability in probabilities.items():
        for family in {MECHANISMS[key].family for key in members}:
            found[family] = found.get(family, 0.0) + probability
    return found
