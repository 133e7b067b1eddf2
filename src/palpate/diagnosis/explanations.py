"""Explanations of one set of recordings with their probabilities, over all sets of mechanisms that may act together.

A set has the evidence of its fit, or one to first order where it is not worth a fit, and a prior: the number of effects
is beta-binomial with as much probability for none as for all others together, and sets of one size are equally
probable. The sets are an odds table, so all of them share one sum, the empty set among them. Where an earlier study on
the same instrument gave the probability of each set of shared effects, that counts for these, and the above for others.

Evidence counts to a power below one where the law is not taken to be exact, see
`palpate.inference.discrepancy.power_of_evidence`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import logsumexp
from scipy.stats import betabinom

from palpate.diagnosis.search import Candidate
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.instrument_prior import InstrumentPrior

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
    power
        Of the evidence.
    instrument
        What an earlier study found of shared mechanisms, which are among those considered; None without one.
    fitted
        The best fit of each set, by its mechanisms.
    estimated
        Of sets that were not fitted the smaller set from which they were estimated, and what the mechanism that joins
        adds to its log evidence to first order.
    exchanged
        Of sets of which no smaller one was fitted a fitted set of as many mechanisms, one of which makes place for
        another one, and what that changes alone.
    """

    considered: int
    power: float = 1.0
    instrument: InstrumentPrior | None = None
    fitted: dict[Members, Candidate] = field(default_factory=dict)
    estimated: dict[Members, tuple[Members, float]] = field(default_factory=dict)
    exchanged: dict[Members, tuple[Members, float]] = field(default_factory=dict)

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
        if before is None or self._estimate(smaller, gain) > self._estimate(*before):
            self.estimated[members] = smaller, gain

    def exchange(self, members: Members, considered: Iterable[str]) -> None:
        """Estimate the sets in which one mechanism of a fitted set makes place for another one.

        What one of them explains alone, more than the other, it explains beside the rest: so are twins, whichever of
        them was fitted first.
        """
        for key, other in itertools.product(sorted(members), considered):
            found, alone = members - {key} | {other}, (frozenset({other}), frozenset({key}))
            if other in members or found in self.fitted or found in self.estimated or not may_act_together(found):
                continue
            if all(each in self.fitted or each in self.estimated for each in alone):
                here, there = map(self._log_evidence, alone)
                trial = members, here - there
                if found not in self.exchanged or self._estimate(*trial) > self._estimate(*self.exchanged[found]):
                    self.exchanged[found] = trial

    def is_exchanged(self, members: Members) -> bool:
        """Return whether nothing better is known of a set than of another one with an exchanged mechanism."""
        return members in self.exchanged and members not in self.fitted and members not in self.estimated

    def _log_evidence(self, members: Members) -> float:
        """Return the log evidence of a set: of its fit, from a smaller one, or of another one with an exchange."""
        if members in self.fitted:
            return self.fitted[members].fit.log_evidence
        if members in self.estimated:
            return self._estimate(*self.estimated[members])
        return self._estimate(*self.exchanged[members])

    def _estimate(self, fitted: Members, gain: float) -> float:
        return self.fitted[fitted].fit.log_evidence + gain

    def log_weight(self, members: Members) -> float:
        """Return the logarithm of a power of a set's evidence times its prior."""
        contradicted = members in self.fitted and self.fitted[members].contradicts
        found = -np.inf if contradicted else self._log_evidence(members)
        return self.power * found + self._log_prior(members)

    def _log_prior(self, members: Members) -> float:
        if self.instrument is None:
            return log_prior(len(members), self.considered)
        others = len(members - self.instrument.keys), self.considered - len(self.instrument.keys)
        return self.instrument.log_probability(members) + log_prior(*others)

    def probabilities(self) -> dict[Members, float]:
        """Return the probability of every set, the likeliest first.

        A set with a mechanism that includes a special case is no rival to the same set with that special case, unless
        it is far likelier: its probability counts for the simpler one where that is not excluded.
        """
        weights = {members: self.log_weight(members) for members in {**self.fitted, **self.estimated, **self.exchanged}}
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


def may_act_together(mechanisms: Iterable[str]) -> bool:
    """Return whether no mechanism of several includes another one."""
    every = set(mechanisms)
    return not any(every & set(MECHANISMS[key].includes) for key in every)


def acting(probabilities: Mapping[Members, float], acts: Mapping[Members, Mapping[str, float]]) -> dict[Members, float]:
    """Return the probability of each set that its mechanisms, and no others, act by more than the smallest effect.

    It follows from the `probabilities` of all sets, and from the probability that each mechanism of a set `acts` by
    more than that; one where not given.
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


def inclusion(probabilities: Mapping[Members, float], families: bool = False) -> dict[str, float]:
    """Return the probability of each mechanism that it acts, over all sets, the likeliest first; or of each family."""
    found: dict[str, float] = {}
    for members, probability in probabilities.items():
        for each in {MECHANISMS[key].family for key in members} if families else members:
            found[each] = found.get(each, 0.0) + probability
    return dict(sorted(found.items(), key=lambda each: -each[1]))
