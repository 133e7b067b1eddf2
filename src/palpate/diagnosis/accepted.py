"""Which of the explanations that were tried are accepted, and which verdict follows."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from palpate.diagnosis.search import Candidate
from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS

CLOSE = np.log(100.0)  # of log evidence, within which explanations are accepted beside each other
NEEDED = 2.0  # of the log evidence: a parameter costs one by Akaike's criterion, about three by Schwarz's


def accepted_of(found: list[Candidate], tried: list[Candidate], level: float) -> list[Candidate]:
    """Return the adequate ones of `found`, best first, whose evidence is within a ratio of 100 of the best tried.

    None may be accepted: where a far likelier explanation still leaves more than noise, the truth is not among the
    adequate ones. An adequate explanation whose likelihood is within the same ratio of that of the likeliest accepted
    one is accepted beside it, even if its evidence is lower because it could have explained much else: the recordings
    do not distinguish them.
    """
    best = best_evidence(tried)
    passed = best_first([candidate for candidate in found if candidate.adequate(level)])
    likely = [each.fit.log_likelihood for each in passed if each.fit.log_evidence >= best - CLOSE]
    return at_least(passed, best - CLOSE, max(likely) - CLOSE) if likely else []


def at_least(candidates: list[Candidate], evidence: float, likelihood: float) -> list[Candidate]:
    """Return the candidates with at least this log evidence, or at least this log-likelihood."""
    return [each for each in candidates if each.fit.log_evidence >= evidence or each.fit.log_likelihood >= likelihood]


def verdict_of(accepted: list[Candidate]) -> tuple[str, list[float]]:
    """Return the verdict, and the probabilities of the accepted explanations."""
    if not accepted:
        return "unexplained", []
    evidence = np.array([candidate.fit.log_evidence for candidate in accepted])
    weights = np.exp(evidence - evidence.max())
    return ("identified" if len(accepted) == 1 else "ambiguous"), (weights / weights.sum()).tolist()


def may_be_named(problem: Problem, explanation: Explanation) -> bool:
    """Return whether the recordings suffice to name the single explanation that is accepted.

    Where at most half of the conditions are repeated, part of the noise is assumed. A single condition determines a
    curve, not a law: a law outside the library may change that curve as an effect on the body does.
    """
    return problem.replicated and (of_instrument(explanation) or len(problem.conditions) > 1)


def zero_on_average(fit: Fit) -> list[str]:
    """Return the instrument's effects of an explanation whose mean amplitudes do not differ from zero at 95 %.

    With their values a and covariance V, a^T V^-1 a is then below the quantile of chi-square. They explain that single
    recordings differ, which chance or another law may cause, too.
    """
    undecided, problem = [], fit.problem
    for key in [key for key in fit.explanation if not MECHANISMS[key].acts_on_body]:
        names = [f"{key}.{name}" for name in MECHANISMS[key].amplitudes]
        places = [problem.place(fit.explanation, name) for name in names]
        values, slopes = np.transpose([problem.quantity(fit.explanation, fit.z, name) for name in names])
        steps = values / slopes
        if steps @ np.linalg.solve(fit.posterior[np.ix_(places, places)], steps) <= chi2.ppf(0.95, len(names)):
            undecided.append(key)
    return undecided


def of_instrument(explanation: Explanation) -> bool:
    """Return whether no mechanism of an explanation acts on the body."""
    return not any(MECHANISMS[key].acts_on_body for key in explanation)


def best_evidence(tried: list[Candidate]) -> float:
    """Return the largest log evidence of the candidates that contradict no exact law."""
    return max((each.fit.log_evidence for each in tried if not each.contradicts), default=-np.inf)


def best_first(candidates: list[Candidate]) -> list[Candidate]:
    """Sort by evidence."""
    return sorted(candidates, key=lambda candidate: -candidate.fit.log_evidence)


def closest_first(candidates: list[Candidate]) -> list[Candidate]:
    """Sort explanations that all fail by their evidence with a discrepancy."""
    return sorted(candidates, key=lambda candidate: -candidate.fit.with_remainder.log_evidence)


def likeliest_of_each(candidates: list[Candidate]) -> list[Candidate]:
    """Return the best candidate of each set of mechanisms, best first; a set may have been fitted more than once."""
    likeliest: dict[frozenset[str], Candidate] = {}
    for candidate in best_first(candidates):
        likeliest.setdefault(frozenset(candidate.fit.explanation), candidate)
    return list(likeliest.values())


def without_redundant(accepted: list[Candidate]) -> list[Candidate]:
    """Return the accepted sets without those of which a special case is accepted: the rest of such a set has no effect.

    A set with as many mechanisms as its special case stays where its log evidence is larger by more than `NEEDED`,
    because the evidence has no penalty for the variance of values that differ between recordings.
    """

    def redundant(each: Fit, other: Fit) -> bool:
        fewer = len(other.explanation) < len(each.explanation)
        special = is_special_case(other.explanation, each.explanation)
        return special and (fewer or each.log_evidence <= other.log_evidence + NEEDED)

    fits = [candidate.fit for candidate in accepted]
    return [candidate for candidate in accepted if not any(redundant(candidate.fit, other) for other in fits)]


def included_in(accepted: list[Candidate], tried: list[Candidate]) -> list[Candidate]:
    """Return those tried that have a mechanism's special case in place of a mechanism of an accepted explanation.

    What such a mechanism adds to its special case may be the effect of another mechanism.
    """
    sets = [each.fit.explanation for each in accepted]
    return [
        each
        for each in tried
        if any(len(s) == len(each.fit.explanation) and is_special_case(each.fit.explanation, s) for s in sets)
    ]


def is_special_case(explanation: Explanation, other: Explanation) -> bool:
    """Return whether an explanation is another one with fewer mechanisms, or with some that those of the other include.

    It cannot fit better, and says less.
    """
    included = {inner for key in other for inner in MECHANISMS[key].includes}
    return set(explanation) != set(other) and set(explanation) <= included.union(other)
