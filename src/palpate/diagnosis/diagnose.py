"""From recordings to the probabilities of all sets of mechanisms, and to a verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from palpate.diagnosis.effect_size import acts, would_act
from palpate.diagnosis.explanations import (
    Explanations,
    Members,
    acting,
    inclusion,
    may_act_together,
    simplest,
    smallest_group,
)
from palpate.diagnosis.search import Candidate, Search
from palpate.diagnosis.side_by_side import ExplanationToTry, ParallelFits
from palpate.errors import PalpateError
from palpate.inference.discrepancy import power_of_evidence
from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS

LIKELY = 0.01  # probability of a set from which on the size of its effects is computed
LIKELIER = 0.5  # probability from which on the law counts as off by more than the tolerance
SURE = 0.95  # probability from which on it counts as within


@dataclass(frozen=True, eq=False)
class DiagnosisOutcome:
    """The verdict, and the fits from which it follows.

    Attributes
    ----------
    verdict
        See `diagnose`.
    law_within_tolerance
        True, False or ``undecided``.
    base
        The base model.
    accepted, probabilities
        The explanations of the group that holds the probability, best first, and their probabilities over all sets;
        none where the base model is adequate or nothing explains the recordings.
    all_sets
        Probability of every set of mechanisms that they, and no others, act by more than the smallest effect, the
        likeliest first.
    sets
        The fits and estimates from which that follows.
    tried
        Every explanation that was fitted, best first.
    failed
        Why others could not be fitted, by their mechanisms.
    """

    verdict: str
    law_within_tolerance: bool | str
    base: Candidate
    accepted: list[Candidate]
    probabilities: list[float]
    all_sets: Mapping[Members, float]
    sets: Explanations
    tried: list[Candidate]
    failed: Mapping[str, str]

    @property
    def best(self) -> Candidate:
        """The best explanation that is accepted, else the base model."""
        return self.accepted[0] if self.accepted else self.base

    @property
    def inclusion(self) -> dict[str, float]:
        """Probability of each mechanism that it acts by more than the smallest effect, over all sets."""
        return inclusion(self.all_sets)

    @property
    def family_inclusion(self) -> dict[str, float]:
        """The same of each family."""
        return inclusion(self.all_sets, families=True)


def diagnose(search: Search, report: Callable[[str], None] = print) -> DiagnosisOutcome:
    """Diagnose the recordings of a search.

    Every set of mechanisms, up to the study's ``diagnosis.largest_set``, has an evidence to first order; the likeliest
    is fitted together with the material on the finite elements, and the sets that are larger by one mechanism are
    estimated anew from there, until no set is left that is not negligible beside the likeliest. The smallest group of
    sets that holds the probability `SearchPolicy.held` gives the verdict. A set that contains another one of the group
    is no rival to it: what more may act is told by the probability that nothing further does.

    ``adequate``     the empty set is in the group, and the law is not off by more than the tolerance;
    ``identified``   there is one set, every family of it is as good as certain, its effects exceed the smallest one and
                     lie within their plausible ranges;
    ``suspected``    there is one set, short of that;
    ``ambiguous``    there are several sets, the empty one not among them;
    ``unexplained``  the law is off by more than the tolerance whatever effects are added, and no family is certain.
    """
    failed = dict(search.screen.failed)
    for key, reason in failed.items():
        report(f"{key}: {reason}")
    base = search.base
    report(f"base model: log evidence {base.fit.log_evidence:.1f}")
    power, instrument = power_of_evidence(base.fit.errors.law), search.problem.scale.instrument
    found = Explanations(len(search.screen.keys), power, instrument)
    found.add(base)
    with ParallelFits(search) as fits:
        _explore(fits, found, failed, report)
    _complete(search, found, report)
    return _verdict(search, found, failed)


def _explore(fits: ParallelFits, found: Explanations, failed: dict[str, str], report: Callable[[str], None]) -> None:
    """Fit sets of mechanisms until none is left that may matter.

    `found` gains the fits and the estimates, and `failed` the reasons why others could not be fitted.
    """
    search = fits.search
    policy, largest = search.policy, search.study.diagnosis.largest_set
    to_try: dict[Members, ExplanationToTry] = {}

    def extend(fit: Fit) -> None:
        if len(fit.explanation) > 1:
            found.exchange(frozenset(fit.explanation), search.screen.keys)
        if len(fit.explanation) >= largest:
            return
        others = [key for key in search.screen.keys if key not in fit.explanation]
        for key in [key for key in others if may_act_together((*fit.explanation, key))]:
            each = ExplanationToTry(fit, key, search.log_evidence(fit, key))
            if each.members in found.fitted or "+".join(sorted(each.members)) in failed:
                continue
            found.estimate(each.members, frozenset(fit.explanation), each.log_evidence - fit.log_evidence)
            if each.members not in to_try or each.log_evidence > to_try[each.members].log_evidence:
                to_try[each.members] = each

    def attainable_weight(each: ExplanationToTry) -> float:
        """Return the weight of a set, or of the likeliest larger one that only a fit of this one leads to."""
        larger = [members for members in found.exchanged if each.members < members and found.is_exchanged(members)]
        return max(map(found.log_weight, [each.members, *larger]))

    def is_worth_a_fit(each: ExplanationToTry, best: Members) -> bool:
        linear = not search.problem.is_simulated(each.key)
        is_no_rival = best < each.members and not search.problem.replicated
        rough = 0.0 if linear else found.power * policy.rough
        negligible = policy.negligible_if_safe if linear or is_no_rival else policy.negligible
        return found.log_weight(best) - attainable_weight(each) <= rough - np.log(negligible)

    def decide() -> set[Members]:
        """Return the sets of the group that gives the verdict, unless the empty one is among them."""
        group = simplest(smallest_group(found.probabilities(), policy.held))
        return set() if frozenset() in group else set(group)

    extend(search.base.fit)
    for _ in range(policy.most if search.problem.replicated else policy.most_alone):
        best, rivals = max(found.fitted, key=found.log_weight), decide()
        worth = [each for each in to_try.values() if each.members in rivals or is_worth_a_fit(each, best)]
        likely = sorted(worth, key=lambda each: -attainable_weight(each))
        if not likely:
            break
        chosen, *others = likely
        del to_try[chosen.members]
        name = "+".join(sorted(chosen.members))
        try:
            candidate = search.candidate(fits.fitted(chosen, others))
        except PalpateError as error:
            failed[name] = str(error)
            found.estimated.pop(chosen.members)
            report(f"{name}: {error}")
            continue
        found.add(candidate)
        evidence = candidate.fit.log_evidence
        report(f"{name}: expected {chosen.log_evidence:.1f}, log evidence {evidence:.1f}")
        extend(found.fitted[chosen.members].fit)


def _complete(search: Search, found: Explanations, report: Callable[[str], None]) -> None:
    """Refit the special cases of the best set from there, and let searches near it go on that were given up."""
    best = max(found.fitted, key=found.log_weight)
    for explanation, z in _special_cases(search, found.fitted[best].fit):
        try:
            found.add(search.candidate(search.fitted(explanation, [z], found.fitted[best].fit.curve)))
        except PalpateError as error:
            report(f"{'+'.join(explanation)} again: {error}")
    least = max(map(found.log_weight, found.fitted)) - search.policy.near
    for members, candidate in list(found.fitted.items()) if search.problem.replicated else ():
        if members and not candidate.fit.converged and found.log_weight(members) >= least:
            found.add(search.followed(candidate))
            report(f"{'+'.join(sorted(members))} in the end: log evidence {found.fitted[members].fit.log_evidence:.1f}")


def _special_cases(search: Search, fit: Fit) -> list[tuple[tuple[str, ...], np.ndarray]]:
    """Return the special cases of a set, each with its coordinates (k,) in the set's own fit.

    Their own searches may have stopped at another local minimum, which the additional mechanism allowed to leave. Those
    far behind to first order, whatever the free parameters become, are left out.
    """
    found = []
    if len(fit.explanation) > 1:
        floor = fit.log_evidence - search.policy.behind_set
        hopeless = {n.explanation for n in search.neighbours(fit) if n.optimistic_log_evidence < floor}
        without = [search.problem.without(fit.explanation, fit.z, key) for key in fit.explanation]
        found += [each for each in without if each[0] not in hopeless]
    for key in fit.explanation:
        for included in [other for other in MECHANISMS[key].includes if other in search.screen.keys]:
            if included not in fit.explanation:
                found.append(search.problem.special_case(fit.explanation, fit.z, key, included))
    return found


def _verdict(search: Search, found: Explanations, failed: Mapping[str, str]) -> DiagnosisOutcome:
    """Return the verdict that follows from the probabilities."""
    settings, policy, base = search.study.diagnosis, search.policy, found.fitted[frozenset()]
    stated = found.probabilities()
    probabilities = acting(stated, _acts(search, found, stated))
    group = [m for m in smallest_group(probabilities, policy.held) if m in found.fitted] or [frozenset()]
    within = [found.fitted[m].within(settings.tolerance, settings.significance) for m in group]
    whole = float(np.average(within, weights=[probabilities[m] for m in group]))
    tolerated = False if whole < 1.0 - LIKELIER else True if whole >= SURE else "undecided"
    families, group = inclusion(probabilities, families=True), simplest(group)
    certain = max(families.values(), default=0.0) >= policy.certain
    if tolerated is False and (base.fit.errors.law is None or not certain):
        verdict, group = "unexplained", []
    elif frozenset() in group:
        verdict, group = "adequate", []
    elif len(group) > 1:
        verdict = "ambiguous"
    else:
        verdict = _of_one_set(search, found.fitted[group[0]].fit, families)
    accepted, of_them = [found.fitted[m] for m in group], [probabilities[m] for m in group]
    tried = [found.fitted[members] for members in sorted(found.fitted, key=lambda each: -found.log_weight(each))]
    return DiagnosisOutcome(verdict, tolerated, base, accepted, of_them, probabilities, found, tried, failed)


def _acts(search: Search, found: Explanations, stated: Mapping[Members, float]) -> dict[Members, dict[str, float]]:
    """Return the probability of each mechanism of a set that its effect exceeds the smallest one, where that matters.

    Of a set that was not fitted, as its last mechanism only adds to the depth, that follows to first order.
    """
    smallest, by_each = search.study.diagnosis.smallest_effect, dict[Members, dict[str, float]]()
    for members in sorted(stated, key=len):
        if members in found.fitted and stated[members] >= LIKELY:
            by_each[members] = {key: acts(found.fitted[members].fit, key, smallest) for key in members}
        elif members in found.estimated:
            smaller, _ = found.estimated[members]
            (key,) = members - smaller
            if not search.problem.is_simulated(key):
                joined = would_act(found.fitted[smaller].fit, key, smallest)
                by_each[members] = by_each.get(smaller, {}) | {key: joined}
    return by_each


def _of_one_set(search: Search, fit: Fit, families: Mapping[str, float]) -> str:
    """Return whether the single set of a group is identified or suspected, by the inclusion of the families."""
    sure = all(families[MECHANISMS[key].family] >= search.policy.certain for key in fit.explanation)
    enough = sufficient_to_identify(search.problem, fit.explanation)
    outside = np.abs(fit.coordinates.beyond(fit.z)[search.problem.material :]).max(initial=0.0) > 0.0
    return "identified" if sure and enough and not outside and not zero_on_average(fit) else "suspected"


def sufficient_to_identify(problem: Problem, explanation: Explanation) -> bool:
    """Return whether the recordings suffice to name the single explanation that is accepted.

    Where at most half of the conditions are repeated, part of the noise is assumed. A single condition determines a
    curve, not a law: a law outside the library may change that curve as an effect on the body does.
    """
    on_body = any(MECHANISMS[key].acts_on_body for key in explanation)
    return problem.replicated and (len(problem.conditions) > 1 or not on_body)


def zero_on_average(fit: Fit) -> list[str]:
    """Return the instrument's effects of an explanation whose mean amplitudes do not differ from zero at 95 %.

    With their values a and covariance V, a^T V^-1 a is then below the quantile of chi-square. They explain that single
    recordings differ, which chance or another law may cause, too. An effect that averages out is judged by its scatter.
    """
    undecided, problem = [], fit.problem
    for key in [key for key in fit.explanation if not (MECHANISMS[key].acts_on_body or MECHANISMS[key].averages_out)]:
        names = [f"{key}.{name}" for name in MECHANISMS[key].amplitudes]
        places = [problem.place(fit.explanation, name) for name in names]
        values, slopes = np.transpose([problem.quantity(fit.explanation, fit.z, name) for name in names])
        steps = values / slopes
        if steps @ np.linalg.solve(fit.posterior[np.ix_(places, places)], steps) <= chi2.ppf(0.95, len(names)):
            undecided.append(key)
    return undecided
