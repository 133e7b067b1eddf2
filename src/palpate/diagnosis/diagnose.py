"""From recordings to a verdict: adequate, identified, suspected, ambiguous or unexplained."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.diagnosis.accepted import (
    CLOSE,
    accepted_of,
    at_least,
    best_first,
    closest_first,
    included_in,
    is_special_case,
    likeliest_of_each,
    may_be_named,
    verdict_of,
    without_redundant,
    zero_on_average,
)
from palpate.diagnosis.search import Candidate, Search
from palpate.diagnosis.side_by_side import Prospect, SideBySide
from palpate.errors import PalpateError
from palpate.inference.explanation import Fit
from palpate.inference.problem import Explanation
from palpate.mechanisms import MECHANISMS


@dataclass(frozen=True, eq=False)
class DiagnosisOutcome:
    """The verdict, and the fits from which it follows.

    Attributes
    ----------
    verdict
        ``adequate``, ``identified``, ``suspected``, ``ambiguous`` or ``unexplained``.
    base
        The base model, and the test of it.
    accepted
        The accepted explanations, best first.
    probabilities
        Their posterior probabilities, if one of them is true.
    tried
        Every explanation that was fitted, best first; where none is accepted, the closest first.
    failed
        Why others could not be fitted, by their mechanisms.
    """

    verdict: str
    base: Candidate
    accepted: list[Candidate]
    probabilities: list[float]
    tried: list[Candidate]
    failed: dict[str, str]


def diagnose(search: Search, report: Callable[[str], None] = print) -> DiagnosisOutcome:
    """Diagnose the recordings of a search.

    The base model is tested first. If it fails, mechanisms are added to it one by one, those with the largest
    optimistic log evidence first; each is fitted together with the material on the finite elements, and its residual is
    tested. An explanation is accepted if its residual is noise and its evidence is within a ratio of 100 of the best
    tried, so that a single accepted one should be wrong in less than one case of a hundred. Where none is, but the
    likeliest leaves no more than noise and the error of the mesh may leave, that is fitted to its end and tested once
    more, see `Search.finished`. So are the accepted ones and those that come close to them, before they are compared.
    As long as none is accepted, sets with one mechanism more are tried in the same way, up to the study's
    ``diagnosis.largest_set``. Larger sets than the accepted ones are fitted where their optimistic log evidence is far
    larger; those that hold a special case of an accepted mechanism in its place, also where it is about as large. One
    that contradicts an exact law is never accepted. A single accepted explanation is identified where the recordings
    suffice, see `may_be_named` and `zero_on_average`; else it is suspected.
    """
    level, base = search.study.diagnosis["significance"], search.base
    failed = dict(search.screen.failed)
    for key, reason in failed.items():
        report(f"{key}: {reason}")
    report(f"base model: log evidence {base.fit.log_evidence:.1f}, p = {base.p_value:.3g}")
    if base.adequate(level):
        return DiagnosisOutcome("adequate", base, [], [], [base], failed)
    with SideBySide(search) as side_by_side:
        accepted, tried = _accepted(side_by_side, failed, report)
    verdict, probabilities = verdict_of(accepted)
    if verdict == "identified":
        best = accepted[0].fit
        if not may_be_named(search.problem, best.explanation) or zero_on_average(best):
            verdict = "suspected"
    return DiagnosisOutcome(verdict, base, accepted, probabilities, tried, failed)


def _accepted(
    side_by_side: SideBySide, failed: dict[str, str], report: Callable[[str], None]
) -> tuple[list[Candidate], list[Candidate]]:
    """Return the accepted explanations, and all that were fitted, both best first.

    Parameters
    ----------
    side_by_side
        Fits explanations.
    failed
        Gains the reasons why others could not be fitted.
    report
        Called with one line on the progress.
    """
    search = side_by_side.search
    level, largest = search.study.diagnosis["significance"], search.study.diagnosis["largest_set"]
    tried, found = [search.base], [search.base]
    for number in range(largest):
        most = search.policy.most_sets if number else search.policy.most
        found = _fitted(side_by_side, found, most, failed, report)
        if found and not any(each.adequate(level) for each in found) and search.explains(found[0].fit):
            found = best_first([*_finished(search, found[:1], report), *found[1:]])
        tried = likeliest_of_each(found + tried)
        if accepted := accepted_of(found, tried, level):
            special = _special_cases(search, accepted[0], tried, report)
            larger = _larger(side_by_side, accepted, special, tried, failed, report) if number + 1 < largest else []
            tried = likeliest_of_each(larger + special + tried)
            accepted = accepted_of(likeliest_of_each(larger + special + accepted), tried, level)
            compared = _compared(search, accepted, tried)
            finished = _finished(search, compared, report)
            tried = likeliest_of_each([*finished, *(each for each in tried if each not in compared)])
            if accepted := accepted_of(finished, finished, level):
                return without_redundant(accepted), tried
            found = [each for each in tried if len(each.fit.explanation) == number + 1]
    closest, *others = closest_first(tried)
    tried = closest_first([*_finished(search, [closest], report), *others])
    accepted = accepted_of(tried[:1], tried, level)
    return accepted, best_first(tried) if accepted else tried


def _larger(
    side_by_side: SideBySide,
    accepted: list[Candidate],
    special: list[Candidate],
    tried: list[Candidate],
    failed: dict[str, str],
    report: Callable[[str], None],
) -> list[Candidate]:
    """Return sets with one mechanism more than accepted ones, and than some with a special case, that may be likely.

    Parameters
    ----------
    special
        Special cases of the accepted ones, refitted.
    side_by_side, accepted, tried, failed, report
        See `_accepted`.
    """
    policy = side_by_side.search.policy
    best = max(each.fit.log_evidence for each in special + accepted)
    likelier, as_likely = best + policy.behind_adequate, best - CLOSE
    larger = _fitted(side_by_side, accepted, policy.most_sets, failed, report, likelier)
    included = included_in(accepted, tried)
    return larger + _fitted(side_by_side, included, policy.most_sets, failed, report, as_likely)


def _compared(search: Search, accepted: list[Candidate], tried: list[Candidate]) -> list[Candidate]:
    """Return the explanations that are compared on finer meshes: those accepted, and others that may be there.

    The base model rests on finer meshes already. The others were fitted on the mesh of the search, which leaves up to
    half of its error beside some mechanisms, so that their evidence is rough.
    """
    if not accepted:
        return []
    possible = [each for each in tried if each in accepted or (search.explains(each.fit) and not each.contradicts)]
    evidence = max(each.fit.log_evidence for each in accepted) - search.policy.behind_adequate
    likelihood = max(each.fit.log_likelihood for each in accepted) - search.policy.behind_adequate
    return at_least(possible, evidence, likelihood)


def _finished(search: Search, explanations: Sequence[Candidate], report: Callable[[str], None]) -> list[Candidate]:
    """Return explanations whose fits went to their ends, best first, see `Search.finished`."""
    found = [search.finished(each) for each in explanations]
    for each in [each for each in found if each not in explanations]:
        name = "+".join(each.fit.explanation)
        report(f"{name} in the end: log evidence {each.fit.log_evidence:.1f}, p = {each.p_value:.3g}")
    return best_first(found)


def _special_cases(
    search: Search, accepted: Candidate, tried: Sequence[Candidate], report: Callable[[str], None]
) -> list[Candidate]:
    """Return the special cases of an accepted set, refitted from its optimum, where that fits better.

    Their own searches may have stopped at another local minimum, which the additional mechanism allowed to leave. Those
    far behind to first order, whatever the free parameters become, are left out.
    """
    fit, better = accepted.fit, []
    floor, smaller = fit.log_evidence - search.policy.behind_set, search.neighbours(fit) if fit.explanation[1:] else []
    hopeless = {each.explanation for each in smaller if each.optimistic_log_evidence < floor}
    for explanation, z in _begun(search, fit):
        if explanation in hopeless:
            continue
        stopped = [each.fit.log_evidence for each in tried if set(each.fit.explanation) == set(explanation)]
        try:
            again = search.examined(search.fitted(explanation, [z], fit.curve))
        except PalpateError as error:
            report(f"{'+'.join(explanation)} again: {error}")
            continue
        if again.fit.log_evidence > max(stopped, default=-np.inf):
            better.append(again)
            report(f"{'+'.join(explanation)} again: log evidence {again.fit.log_evidence:.1f}, p = {again.p_value:.3g}")
    return better


def _begun(search: Search, fit: Fit) -> Iterator[tuple[Explanation, np.ndarray]]:
    """Yield the special cases of a set, each with its coordinates (k,) in the set's own fit."""
    for key in fit.explanation:
        if len(fit.explanation) > 1:
            yield search.problem.without(fit.explanation, fit.z, key)
        for included in [other for other in MECHANISMS[key].includes if other in search.screen.keys]:
            yield search.problem.special_case(fit.explanation, fit.z, key, included)


def _prospects(search: Search, fits: Sequence[Fit]) -> dict[frozenset[str], Prospect]:
    """Return the sets with one mechanism more than `fits`, by their mechanisms; of each the most optimistic way to it.

    Its optimistic log evidence is that of the smaller set, which is an optimistic one itself where that fit was given
    up, plus the largest gain that the effects on curves and the exact laws, those about the mechanism that joins and
    those that it breaks, allow for it. A mechanism and one that it includes do not act together.
    """
    ways: dict[frozenset[str], Prospect] = {}
    for fit in fits:
        misfits = list(zip(fit.laws, fit.law_misfits, strict=True))
        for key in [key for key in search.screen.keys if key not in fit.explanation]:
            if any(is_special_case((key,), (other,)) or is_special_case((other,), (key,)) for other in fit.explanation):
                continue
            own, joined = (key, *MECHANISMS[key].includes), (*fit.explanation, key)
            of_laws = sum(misfit for law, misfit in misfits if law.key in own or not law.holds_under(joined))
            begun = fit.log_evidence if fit.converged else fit.optimistic_log_evidence
            way = Prospect(fit, key, begun + 0.5 * (search.screen.gain(fit, key) + of_laws))
            if way.members not in ways or way.optimistic > ways[way.members].optimistic:
                ways[way.members] = way
    return ways


def _matters_beside(search: Search, way: Prospect, evidence: float) -> bool:
    """Return whether a prospect may be accepted beside an adequate set of that log evidence, or make it unlikely."""
    return way.optimistic > evidence + CLOSE or not search.cannot_leave_noise(way.fit, way.key)


def _fitted(
    side_by_side: SideBySide,
    smaller: Sequence[Candidate],
    most: int,
    failed: dict[str, str],
    report: Callable[[str], None],
    floor: float = -np.inf,
) -> list[Candidate]:
    """Fit the sets with one mechanism more that have the largest optimistic log evidence, and return them, best first.

    None is fitted whose optimistic log evidence lies below the `floor`.

    Sets far behind the best are left out where the estimate is trusted: that from a fit not far from the recordings,
    and any once some are fitted or one leaves about as much as noise. Once a set is adequate, those that could not be
    accepted beside it are left out, too. A linearisation holds near one point only: where the residual of a set is
    close to noise, sets with another mechanism in place of one of its own are estimated again from there, and their
    search starts there.
    """
    search, done = side_by_side.search, list[Candidate]()
    policy, level = search.policy, search.study.diagnosis["significance"]
    behind, ways = -np.inf, _prospects(search, [candidate.fit for candidate in smaller])
    for _ in range(most):
        if not ways:
            break
        way, *likely = sorted(ways.values(), key=lambda way: -way.optimistic)
        del ways[way.members]
        explained = any(each.adequate(level) or search.explains(each.fit) for each in done)
        trusted = explained or len(done) >= policy.least or way.fit.misfit_ratio <= policy.trusted
        if way.optimistic < floor or (trusted and way.optimistic < behind):
            break
        name = "+".join(sorted([*way.fit.explanation, way.key]))
        try:
            candidate = search.examined(side_by_side.fitted(way, likely))
        except PalpateError as error:
            failed[name] = str(error)
            report(f"{name}: {error}")
            continue
        done.append(candidate)
        failed.pop(name, None)
        evidence = candidate.fit.log_evidence
        behind = max(behind, evidence - (policy.behind_adequate if candidate.adequate(level) else policy.behind_best))
        report(
            f"{name}: expected at best {way.optimistic:.1f}, log evidence {evidence:.1f}, p = {candidate.p_value:.3g}"
        )
        if candidate.adequate(level):
            ways = {members: way for members, way in ways.items() if _matters_beside(search, way, evidence)}
        for members, other in _prospects(search, search.neighbours(candidate.fit)).items():
            if members in ways and other.optimistic > ways[members].optimistic:
                ways[members] = other
    return best_first(done)
