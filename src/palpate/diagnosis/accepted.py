"""Which explanations are accepted of those that were tried, and what may be said of them."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from palpate.diagnosis.search import Candidate
from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS

CLOSE = np.log(100.0)
NEEDED = 2.0  # of the log evidence: a parameter costs one by Akaike's criterion, about three by Schwarz's


def accepted_of(found: list[Candidate], tried: list[Candidate], level: float) -> list[Candidate]:
    """Return what passes of `found`, best first, within a ratio of 100 of the best of all that were tried.

    The best may not be accepted: where something far likelier still leaves more than noise, the truth is not among
    those that pass. What passes and fits as well as an accepted one, but for a ratio of the likelihood, is accepted
    beside it, though the evidence counts against it that it could have explained much else: recordings do not tell them
    apart.
    """
    best = best_evidence(tried)
    passed = best_first([candidate for candidate in found if candidate.adequate(level)])
    likely = [candidate.fit.log_likelihood for candidate in passed if candidate.fit.log_evidence >= best - CLOSE]
    if not likely:
        return []
    fits = max(likely)
    return [each for each in passed if each.fit.log_evidence >= best - CLOSE or each.fit.log_likelihood >= fits - CLOSE]


def judged(accepted: list[Candidate]) -> tuple[str, list[float]]:
    """Return the verdict, and the probabilities of the accepted explanations."""
    if not accepted:
        return "unexplained", []
    evidence = np.array([candidate.fit.log_evidence for candidate in accepted])
    weights = np.exp(evidence - evidence.max())
    return ("identified" if len(accepted) == 1 else "ambiguous"), (weights / weights.sum()).tolist()


def may_be_named(problem: Problem, explanation: Explanation) -> bool:
    """Return whether recordings bear a name alone, where a single explanation is accepted.

    Where most conditions have no replicates, part of the noise is assumed. A single condition fixes a curve and not a
    law: what an effect on the body does to one curve, a law that is in no library may do, too.
    """
    return problem.replicated and (of_instrument(explanation) or len(problem.conditions) > 1)


def not_told_from_none(fit: Fit) -> list[str]:
    """Return the instrument's effects of an explanation whose mean amplitudes may as well all be none, at 95 %.

    With their values a and covariance V, a^T V^-1 a is then below the quantile of chi-square. What they explain is that
    single recordings differ, which chance, or another law, may do, too.
    """
    open_ones, problem = [], fit.problem
    for key in [key for key in fit.explanation if not MECHANISMS[key].acts_on_body]:
        names = [f"{key}.{name}" for name in MECHANISMS[key].amplitudes]
        places = [problem.place(fit.explanation, name) for name in names]
        values, slopes = np.transpose([problem.quantity(fit.explanation, fit.z, name) for name in names])
        steps = values / slopes
        if steps @ np.linalg.solve(fit.posterior[np.ix_(places, places)], steps) <= chi2.ppf(0.95, len(names)):
            open_ones.append(key)
    return open_ones


def of_instrument(explanation: Explanation) -> bool:
    """Return whether no mechanism of an explanation acts on the body."""
    return not any(MECHANISMS[key].acts_on_body for key in explanation)


def best_evidence(tried: list[Candidate]) -> float:
    """Return the greatest logarithm of the evidence of those that contradict no law."""
    return max((each.fit.log_evidence for each in tried if not each.contradicts), default=-np.inf)


def best_first(candidates: list[Candidate]) -> list[Candidate]:
    """Sort by evidence."""
    return sorted(candidates, key=lambda candidate: -candidate.fit.log_evidence)


def likeliest_of_each(candidates: list[Candidate]) -> list[Candidate]:
    """Return one candidate for each set of mechanisms, best first: a set that was fitted again is listed once."""
    likeliest: dict[frozenset[str], Candidate] = {}
    for candidate in best_first(candidates):
        likeliest.setdefault(frozenset(candidate.fit.explanation), candidate)
    return list(likeliest.values())


def without_idle(accepted: list[Candidate]) -> list[Candidate]:
    """Return the accepted sets, but for those of which a special case is accepted: they hold what does nothing.

    One with as many mechanisms as its special case stays where its evidence is larger by more than `NEEDED`: the
    evidence charges nothing for the variance of values that recordings have of their own.
    """

    def idle(each: Fit, other: Fit) -> bool:
        fewer = len(other.explanation) < len(each.explanation)
        special = is_special_case(other.explanation, each.explanation)
        return special and (fewer or each.log_evidence <= other.log_evidence + NEEDED)

    fits = [candidate.fit for candidate in accepted]
    return [candidate for candidate in accepted if not any(idle(candidate.fit, other) for other in fits)]


def is_special_case(explanation: Explanation, other: Explanation) -> bool:
    """Return whether an explanation is another one with fewer mechanisms, or with some that those of the other include.

    It cannot fit better, and says less.
    """
    included = {inner for key in other for inner in MECHANISMS[key].includes}
    return set(explanation) != set(other) and set(explanation) <= included.union(other)
