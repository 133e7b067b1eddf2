"""From recordings to a verdict: adequate, identified, ambiguous or unexplained."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate.config import Study
from palpate.diagnosis.detect import gains
from palpate.diagnosis.fit import Fit
from palpate.diagnosis.problem import Problem
from palpate.diagnosis.refine import ABSURD, SETTLED
from palpate.diagnosis.search import Candidate, LawsBeside, Search
from palpate.diagnosis.standing import (
    best_evidence,
    best_first,
    judged,
    likeliest_of_each,
    may_be_named,
    not_told_from_none,
    of_instrument,
    standing_of,
    tested,
    without_idle,
)

SCREENED, FAR = 40.0, 200.0
OUTDONE = 10.0  # logarithm of the evidence behind another, from which neither rounds nor sharpening bring one back
LEAST_REFINED, MOST_REFINED, MOST_REFINED_SETS = 3, 8, 5
MOST_SETS = 12


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The verdict and what led to it.

    Attributes
    ----------
    verdict
        ``adequate``, ``identified``, ``ambiguous`` or ``unexplained``.
    base
        The base model, and the test of it.
    standing
        The explanations that stand, best first.
    probabilities
        Theirs, were there no others.
    tried
        Every explanation tried, best first; one that was tried again as it came out better.
    """

    verdict: str
    base: Candidate
    standing: list[Candidate]
    probabilities: list[float]
    tried: list[Candidate]


def diagnose(
    study: Study,
    problem: Problem,
    keys: list[str],
    rng: np.random.Generator,
    report: Callable[[str], None] = print,
    laws: LawsBeside | None = None,
) -> Diagnosis:
    """Diagnose one set of recordings.

    The base model is tested first. If it fails, every mechanism is fitted together with the material; those whose
    evidence is near the best go to the forward model and are tested in turn, once more with the forward model's own
    slopes where that may decide. One stands that leaves only noise, within a ratio of 100 of the best tried, so that a
    name given alone should be wrong in less than one case of a hundred. While none stands, sets with one mechanism more
    are tried in the same way, up to the study's ``diagnosis.largest_set``. One that contradicts an exact law never
    passes.
    A name is given alone only where the recordings bear it, see `may_be_named` and `not_told_from_none`.

    Parameters
    ----------
    keys
        Mechanisms to consider.
    laws
        Returns what exact laws say about amplitudes beside a fit of the base model.
    """
    level = study.diagnosis["significance"]
    search = Search(study, problem, keys, rng, laws)
    base = search.refined(search.base())
    report(f"base model: p = {base.p_value:.3g}")
    if base.adequate(level):
        return Diagnosis("adequate", base, [], [], [base])
    singles = [search.extended(base.fit, key) for key in keys]
    found = _refine_best(search, singles, MOST_REFINED, level, report)
    tried, standing = _sharpened(search, found, [*found, base], level)
    for _ in range(1, study.diagnosis["largest_set"]):
        if standing:
            break
        wider = [search.extended(fit, key) for fit, key in _larger_sets(found, keys)]
        found = _refine_best(search, wider, MOST_REFINED_SETS, level, report)
        tried, standing = _sharpened(search, found, found + tried, level)
        if resumed := _resumed(search, standing, tried, report):
            tried, again = _sharpened(search, resumed, resumed + tried, level)
            standing = standing_of([*again, *without_idle(standing, again)], tried, level)
    verdict, probabilities = judged(standing)
    if verdict == "identified":
        best = standing[0].fit
        if not may_be_named(problem, best.explanation) or not_told_from_none(best):
            verdict = "ambiguous"
    return Diagnosis(verdict, base, standing, probabilities, likeliest_of_each(tried))


def _refine_best(
    search: Search, fits: list[Fit], most: int, level: float, report: Callable[[str], None]
) -> list[Candidate]:
    """Put the fits that promise most on the forward model, and some more where none passes; return all, best first.

    A promise is measured by what the forward model has shown of others, not by what these had promised: surrogates that
    are hard to learn promise too much. What falls far behind is left to the surrogates, and once one passes, what falls
    behind by so much that it would not stand beside it.
    """
    fits = sorted(fits, key=lambda fit: -fit.promise)
    done: list[Candidate] = []
    near, far, least = -np.inf, -np.inf, -np.inf
    for k, fit in enumerate(fits):
        worth = fit.misfit < ABSURD * len(fit.residual) and fit.promise > far
        if (k < LEAST_REFINED and least == -np.inf and worth) or (k < most and fit.promise > max(near, least)):
            candidate = search.refined(fit, least)
            near = max(near, candidate.fit.log_evidence - SCREENED)
            far = max(far, candidate.fit.log_evidence - FAR)
            if candidate.adequate(level):
                least = max(least, candidate.fit.log_evidence - OUTDONE)
            report(f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}, {candidate.seen}")
        else:
            candidate = Candidate(fit)
            report(f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}")
        done.append(candidate)
    return best_first(done)


def _resumed(
    search: Search, standing: list[Candidate], tried: list[Candidate], report: Callable[[str], None]
) -> list[Candidate]:
    """Return sets, each on the forward model again from where a larger one that stands ended without its mechanism.

    Those that fit better there, once the others make up for the mechanism, than where their own search had stopped: in
    a valley of the surrogates, out of which the coordinate of an effect that does nothing led.
    """
    stopped = {frozenset(each.fit.explanation): each.fit for each in reversed(tried) if each.confirmed}
    starts: dict[frozenset[str], Fit] = {}
    for candidate in standing:
        for key in candidate.fit.explanation:
            start = search.settled(search.without(candidate.fit, key))
            members = frozenset(start.explanation)
            best = starts.get(members, stopped.get(members))
            if best and 2.0 * (start.log_likelihood - best.log_likelihood) > SETTLED:
                starts[members] = start
    resumed = []
    for start in starts.values():
        resumed.append(search.refined(start))
        report(f"{'+'.join(start.explanation)} again: {resumed[-1].seen}")
    return resumed


def _sharpened(
    search: Search, found: list[Candidate], tried: list[Candidate], level: float
) -> tuple[list[Candidate], list[Candidate]]:
    """Return all that were tried and what stands of `found`, sharpened, both best first.

    Where one turns out less likely than it had seemed, or to leave more than noise, others may stand beside it, or
    instead of it; they are sharpened in turn.
    """
    done: list[Candidate] = []
    while rough := _in_question(search, [each for each in found if each not in done], tried, level):
        better = {candidate: search.sharpened(candidate) for candidate in rough}
        found, tried = ([better.get(candidate, candidate) for candidate in each] for each in (found, tried))
        done += better.values()
    return best_first(tried), standing_of(found, tried, level)


def _in_question(search: Search, found: list[Candidate], tried: list[Candidate], level: float) -> list[Candidate]:
    """Return those of `found` that may stand once they are sharpened.

    With the surrogates' slopes a search may stop beside its optimum. That costs evidence, of one explanation more than
    of another, and may leave more than noise. So all that stand, or fail by little, are compared by the same slopes.
    Where none acts on the body, those are the base model's, which are well known.
    """
    best = best_evidence(tried)
    near = [each for each in tested(found) if each.confirmed and each.fit.log_evidence >= best - OUTDONE]
    near = [each for each in near if each.adequate(level) or search.lacking(each.fit) < 2.0 * OUTDONE]
    near += [each for each in standing_of(found, tried, level) if each.confirmed and each not in near]
    return near if any(not of_instrument(each.fit.explanation) for each in near) else []


def _larger_sets(tried: list[Candidate], keys: list[str]) -> list[tuple[Fit, str]]:
    """Return the sets with one mechanism more that promise the greatest evidence.

    What a set promises is the evidence of the smaller one, plus what filters and laws see of the mechanism that joins.
    Of several ways to a set the one counts that begins on the forward model, if any does: what that corrected stays so.
    """
    promised: dict[frozenset[str], tuple[bool, float, Fit, str]] = {}
    for candidate in tried:
        fit, gain = candidate.fit, gains(candidate.fit, keys)
        for key in [key for key in keys if key not in fit.explanation]:
            asked = sum(off**2 for law, off in zip(fit.laws, fit.from_laws(fit.z), strict=True) if law.key == key)
            score = fit.promise + 0.5 * (gain[key] + asked)
            wider = frozenset((*fit.explanation, key))
            if wider not in promised or (candidate.confirmed, score) > promised[wider][:2]:
                promised[wider] = candidate.confirmed, score, fit, key
    return [(fit, key) for _, _, fit, key in sorted(promised.values(), key=lambda entry: -entry[1])[:MOST_SETS]]
