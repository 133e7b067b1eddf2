"""From recordings to a verdict: adequate, identified, ambiguous or unexplained."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.config import Study
from palpate.diagnosis.correction import Correction
from palpate.diagnosis.covariance import Errors, errors, noise_of, varying
from palpate.diagnosis.detect import examine, excess, gains
from palpate.diagnosis.fit import Fit, solve, starting_points
from palpate.diagnosis.law import Law
from palpate.diagnosis.laws import contradicted
from palpate.diagnosis.noise import NoiseModel
from palpate.diagnosis.problem import Explanation, Problem
from palpate.diagnosis.refine import ABSURD, hopeless, refine, sharpen
from palpate.errors import PalpateError
from palpate.mechanisms import MECHANISMS

LawsBeside = Callable[[Fit], Sequence[Law]]

CLOSE = np.log(100.0)
SCREENED, RIVALS, FAR = 40.0, 30.0, 200.0
OUTDONE = 10.0  # logarithm of the evidence behind another, from which neither rounds nor sharpening bring one back
LEAST_REFINED, MOST_REFINED, MOST_REFINED_SETS = 3, 8, 5
MOST_SETS = 12
QUIETER = 2.0  # logarithm of the likelihood of what is left, by which one more mechanism must raise it


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation that was tried.

    Attributes
    ----------
    fit
        Its best parameters, on the forward model where it was among the best.
    p_value
        Of what it leaves being noise; ``None`` where it was not among the best.
    confirmed
        Whether the forward model ran with it; else it rests on surrogates.
    contradicts
        The exact laws that its amplitudes contradict.
    """

    fit: Fit
    p_value: float | None = None
    confirmed: bool = False
    contradicts: tuple[Law, ...] = ()

    @property
    def seen(self) -> str:
        """What the forward model has shown of it, in words."""
        return f"on the forward model {self.fit.log_evidence:.1f}, p = {self.p_value:.3g}"

    def adequate(self, significance: float) -> bool:
        """Return whether nothing but noise is left and no exact law is contradicted."""
        return self.p_value is not None and self.p_value >= significance and not self.contradicts


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
        Every explanation tried, best first.
    """

    verdict: str
    base: Candidate
    standing: list[Candidate]
    probabilities: list[float]
    tried: list[Candidate]


class Search:
    """The search for explanations; keeps what has been fitted."""

    def __init__(
        self, study: Study, problem: Problem, keys: list[str], rng: np.random.Generator, laws: LawsBeside | None = None
    ):
        self._study, self._problem, self._keys, self._rng = study, problem, keys, rng
        self._settings, self._calibration = study.diagnosis, study.calibration
        self._laws: Sequence[Law] = ()
        self._hear(np.zeros(len(problem.mean)))
        if laws:
            self._laws = laws(self.base())
        if not problem.replicated:
            self._listen()

    def _listen(self) -> None:
        """Take for noise, without replicates, what that fit leaves which leaves least beside slow trends.

        One that fits worse would allow itself more noise, but what is compared has to be measured by the same. Sets
        grow from the base model, as long as one more mechanism makes what is left much likelier.
        """
        self._hear(self.base().residual)
        quietest = self.base()
        for _ in range(self._settings["largest_set"]):
            self._hear(quietest.residual)
            wider = [self.extended(quietest, key) for key in self._keys if key not in quietest.explanation]
            heard, quietest = quietest, max([quietest, *wider], key=self._quietness)
            if quietest is heard:
                return
        self._hear(quietest.residual)

    def _hear(self, residual: np.ndarray) -> None:
        """Take a residual (n_all,) for noise where nothing is replicated."""
        self._heard = residual
        self._noise: dict[tuple[str, ...], NoiseModel] = {}

    def _quietness(self, fit: Fit) -> float:
        """Return the logarithm of the likelihood of what a fit leaves beside slow trends, less what mechanisms cost."""
        left = noise_of(self._problem, (), fit.residual, self._calibration["site_scatter"])
        return left.log_likelihood - QUIETER * len(fit.explanation)

    def base(self) -> Fit:
        """Fit the base model."""
        problem = self._problem
        middle = [np.full(problem.space.dimensions, 0.5)]
        first = self._errors((), np.zeros(len(problem.mean)))
        rough = solve(problem, (), first, middle)
        return solve(problem, (), self._errors((), rough.residual), [rough.z, *middle], laws=self._laws)

    def extended(self, fit: Fit, key: str) -> Fit:
        """Fit an explanation and one more mechanism; what the forward model corrected in the first stays corrected.

        Where the first was hopeless the second lies elsewhere, and what was corrected there says nothing.
        """
        wider: Explanation = (*fit.explanation, key)
        correction = None if hopeless(fit) else fit.correction.widened(self._problem.dimensions(wider))
        found = self._errors(wider, fit.residual)
        best = solve(self._problem, wider, found, starting_points(fit, key), correction, laws=self._laws)
        weighed = self._errors(wider, best.residual, best.z)
        return solve(self._problem, wider, weighed, [best.z], correction, laws=self._laws)

    def without(self, fit: Fit, key: str) -> Fit:
        """Return the explanation with one mechanism less, where a fit ended, on its curves less the effect there."""
        u, own = self._problem.parts(fit.explanation, fit.z)
        smaller: Explanation = tuple(other for other in fit.explanation if other != key)
        z = np.concatenate([u, *(own[other] for other in smaller)])
        curve = fit.curve - self._problem.effect(key, u, own[key])[0]
        correction = Correction.constant(z, curve - self._problem.curves(smaller, z[None])[0])
        errors_there = self._errors(smaller, self._problem.mean - curve, z).exact
        return Fit(self._problem, smaller, z, errors_there, correction, tuple(self._laws))

    def refined(self, fit: Fit, least: float = -np.inf) -> Candidate:
        """Put a fit on the forward model, where that runs, and examine what it leaves; see `refine` for `least`."""
        try:
            return replace(self.examined(refine(self._study, fit, self.lacking, least)), confirmed=True)
        except PalpateError:
            return self.examined(fit)

    def sharpened(self, candidate: Candidate) -> Candidate:
        """Put the forward model's own slopes in place of the surrogates' around an explanation.

        Its intervals rest on them, and what was learnt of an effect on the body, among few materials, is rough.
        """
        fit = candidate.fit
        weighed = self._errors(fit.explanation, fit.residual, fit.z).exact
        fit = replace(fit, errors=replace(weighed, between=fit.errors.between))
        try:
            return replace(self.examined(sharpen(self._study, fit)), confirmed=True)
        except PalpateError:
            return candidate

    def examined(self, fit: Fit) -> Candidate:
        """Test what a fit leaves."""
        left = examine(fit, self._keys, self._rng, self._settings["bootstrap"], self._calibration["site_scatter"])
        return Candidate(fit, left, contradicts=tuple(contradicted(fit, self._laws)))

    def lacking(self, fit: Fit) -> float:
        """Return by how much the chi-square of a fit must fall before what it leaves passes for noise."""
        draws, level = self._settings["bootstrap"], self._settings["significance"]
        return excess(fit, self._keys, self._rng, draws, level)

    def _errors(self, explanation: Explanation, residual: np.ndarray, z: np.ndarray | None = None) -> Errors:
        site_scatter, solver_error = (self._calibration[key] for key in ("site_scatter", "solver_error"))
        keys = varying(explanation)
        if keys not in self._noise:
            self._noise[keys] = noise_of(self._problem, keys, self._heard, site_scatter)
        return errors(self._problem, explanation, residual, self._noise[keys], solver_error, z)


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
    A name is given alone only where the recordings bear it, see `may_be_named`.

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
            standing = _standing([*again, *_without_idle(standing, again)], tried, level)
    verdict, probabilities = _judge(standing)
    if verdict == "identified" and not may_be_named(problem, standing[0].fit.explanation):
        verdict = "ambiguous"
    return Diagnosis(verdict, base, standing, probabilities, tried)


def _refine_best(
    search: Search, fits: list[Fit], most: int, level: float, report: Callable[[str], None]
) -> list[Candidate]:
    """Put the fits that promise most on the forward model, and some more where none passes; return all, best first.

    Once one passes, only those matter that promise nearly as much. What promises far less than one that the forward
    model has seen is left to the surrogates.
    """
    fits = sorted(fits, key=lambda fit: -fit.promise)
    done: list[Candidate] = []
    near, far, least = fits[0].promise - SCREENED, -np.inf, -np.inf
    for k, fit in enumerate(fits):
        worth = fit.misfit < ABSURD * len(fit.residual) and fit.promise > far
        if (k < LEAST_REFINED and least == -np.inf and worth) or (k < most and fit.promise > max(near, least)):
            candidate = search.refined(fit, least)
            far = max(far, candidate.fit.log_evidence - FAR)
            if candidate.adequate(level):
                near = max(near, fit.promise - RIVALS)
                least = max(least, candidate.fit.log_evidence - OUTDONE)
            report(f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}, {candidate.seen}")
        else:
            candidate = Candidate(fit)
            report(f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}")
        done.append(candidate)
    return _best_first(done)


def _resumed(
    search: Search, standing: list[Candidate], tried: list[Candidate], report: Callable[[str], None]
) -> list[Candidate]:
    """Return sets, each on the forward model again from where a larger one that stands ended without its mechanism.

    Those that fit better there than where their own search had stopped: in a valley of the surrogates, out of which
    the coordinate of an effect that does nothing led.
    """
    stopped = {frozenset(each.fit.explanation): each.fit for each in reversed(tried) if each.confirmed}
    resumed = []
    for candidate in standing:
        for key in candidate.fit.explanation:
            start = search.without(candidate.fit, key)
            fit = stopped.get(frozenset(start.explanation))
            if fit and start.log_likelihood > fit.log_likelihood:
                resumed.append(search.refined(start))
                report(f"{'+'.join(start.explanation)} again: {resumed[-1].seen}")
    return resumed


def _without_idle(standing: list[Candidate], smaller: list[Candidate]) -> list[Candidate]:
    """Return the sets that stand, but for those around a smaller one that stands, too: they hold what does nothing."""
    within = [set(candidate.fit.explanation) for candidate in smaller]
    return [each for each in standing if not any(fewer < set(each.fit.explanation) for fewer in within)]


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
    return _best_first(tried), _standing(found, tried, level)


def _in_question(search: Search, found: list[Candidate], tried: list[Candidate], level: float) -> list[Candidate]:
    """Return those of `found` that may stand once they are sharpened.

    With the surrogates' slopes a search may stop beside its optimum. That costs evidence, of one explanation more than
    of another, and may leave more than noise. So all that stand, or fail by little, are compared by the same slopes.
    Where none acts on the body, those are the base model's, which are well known.
    """
    best = _best_evidence(tried)
    near = [each for each in _tested(found) if each.confirmed and each.fit.log_evidence >= best - OUTDONE]
    near = [each for each in near if each.adequate(level) or search.lacking(each.fit) < 2.0 * OUTDONE]
    near += [each for each in _standing(found, tried, level) if each.confirmed and each not in near]
    return near if any(not of_instrument(each.fit.explanation) for each in near) else []


def _tested(candidates: list[Candidate]) -> list[Candidate]:
    return [candidate for candidate in candidates if candidate.p_value is not None and not candidate.contradicts]


def _best_evidence(tried: list[Candidate]) -> float:
    return max((each.fit.log_evidence for each in _tested(tried)), default=-np.inf)


def _best_first(candidates: list[Candidate]) -> list[Candidate]:
    return sorted(candidates, key=lambda candidate: -candidate.fit.log_evidence)


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


def _standing(found: list[Candidate], tried: list[Candidate], level: float) -> list[Candidate]:
    """Return what passes of `found`, best first, within a ratio of 100 of the best of all that were tried.

    The best may not stand: where something far likelier still leaves more than noise, the truth is not among those
    that pass. What passes and fits as well as one that stands, but for a ratio of the likelihood, stands beside it,
    though the evidence counts against it that it could have explained much else: recordings do not tell them apart.
    """
    best = _best_evidence(tried)
    passed = _best_first([candidate for candidate in found if candidate.adequate(level)])
    likely = [candidate.fit.log_likelihood for candidate in passed if candidate.fit.log_evidence >= best - CLOSE]
    if not likely:
        return []
    fits = max(likely)
    return [each for each in passed if each.fit.log_evidence >= best - CLOSE or each.fit.log_likelihood >= fits - CLOSE]


def may_be_named(problem: Problem, explanation: Explanation) -> bool:
    """Return whether recordings bear a name alone, where a single explanation stands.

    Where most conditions have no replicates, part of the noise is assumed. A single condition fixes a curve and not a
    law: what an effect on the body does to one curve, a law that is in no library may do, too.
    """
    return problem.replicated and (of_instrument(explanation) or len(problem.conditions) > 1)


def of_instrument(explanation: Explanation) -> bool:
    """Return whether no mechanism of an explanation acts on the body."""
    return not any(MECHANISMS[key].needs_learning for key in explanation)


def _judge(standing: list[Candidate]) -> tuple[str, list[float]]:
    """Return the verdict, and the probabilities of the explanations that stand."""
    if not standing:
        return "unexplained", []
    evidence = np.array([candidate.fit.log_evidence for candidate in standing])
    weights = np.exp(evidence - evidence.max())
    return ("identified" if len(standing) == 1 else "ambiguous"), (weights / weights.sum()).tolist()
