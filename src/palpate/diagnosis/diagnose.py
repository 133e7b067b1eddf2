"""From recordings to a verdict: adequate, identified, ambiguous or unexplained."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from palpate.config import Study
from palpate.diagnosis.covariance import errors
from palpate.diagnosis.detect import Examination, examine
from palpate.diagnosis.fit import Fit, solve, starting_points
from palpate.diagnosis.problem import Explanation, Problem
from palpate.diagnosis.refine import refine

CLOSE = np.log(20.0)
SCREENED = 40.0
MOST_REFINED = 5
MOST_PAIRS = 8


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation that was tried.

    Attributes
    ----------
    fit
        Its best parameters, on the forward model where it was among the best.
    examination
        Whether anything is left; ``None`` where it was not among the best.
    """

    fit: Fit
    examination: Examination | None = None

    def adequate(self, significance: float) -> bool:
        """Return whether nothing but noise is left."""
        return self.examination is not None and self.examination.p_value >= significance


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
        Theirs, among all explanations tried.
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

    def __init__(self, study: Study, problem: Problem, keys: list[str], rng: np.random.Generator):
        self._study, self._problem, self._keys, self._rng = study, problem, keys, rng
        self._settings, self._calibration = study.diagnosis, study.calibration

    def base(self) -> Fit:
        """Fit the base model."""
        problem = self._problem
        middle = [np.full(problem.space.dimensions, 0.5)]
        first = self._errors((), np.zeros(len(problem.mean)))
        rough = solve(problem, (), first, middle)
        return solve(problem, (), self._errors((), rough.residual), [rough.z, *middle])

    def extended(self, fit: Fit, key: str) -> Fit:
        """Fit an explanation and one more mechanism."""
        wider: Explanation = (*fit.explanation, key)
        found = self._errors(wider, fit.residual)
        best = solve(self._problem, wider, found, starting_points(fit, key))
        return solve(self._problem, wider, self._errors(wider, best.residual), [best.z])

    def refined(self, fit: Fit) -> Candidate:
        """Put a fit on the forward model and examine what it leaves."""
        return self.examined(refine(self._study, fit))

    def examined(self, fit: Fit) -> Candidate:
        """Test what a fit leaves."""
        return Candidate(
            fit, examine(fit, self._keys, self._rng, self._settings["bootstrap"], self._calibration["site_scatter"])
        )

    def _errors(self, explanation: Explanation, residual: np.ndarray):
        calibration = self._calibration
        return errors(self._problem, explanation, residual, calibration["site_scatter"], calibration["solver_error"])


def diagnose(
    study: Study, problem: Problem, keys: list[str], rng: np.random.Generator, report: Callable[[str], None] = print
) -> Diagnosis:
    """Diagnose one set of recordings.

    The base model is tested first. If it fails, every mechanism is fitted together with the material; those whose
    evidence is near the best go to the forward model and are tested in turn. If none of them leaves only noise, pairs
    are tried in the same way. Among the smallest explanations that pass, those within a likelihood ratio of 20 stand.
    Without replicates part of the noise is assumed, and no explanation is given alone.

    Parameters
    ----------
    keys
        Mechanisms to consider.
    """
    level = study.diagnosis["significance"]
    search = Search(study, problem, keys, rng)
    base = search.examined(search.base())
    report(f"base model: p = {base.examination.p_value:.3g}")  # type: ignore[union-attr]
    if base.adequate(level):
        return Diagnosis("adequate", base, [], [], [base])
    base = search.refined(base.fit)
    if base.adequate(level):
        return Diagnosis("adequate", base, [], [], [base])
    singles = _refine_best(search, [search.extended(base.fit, key) for key in keys], report)
    tried = singles
    standing = [candidate for candidate in singles if candidate.adequate(level)]
    if not standing:
        promising = _pairs(singles, keys)
        pairs = _refine_best(search, [search.extended(fit, key) for fit, key in promising], report)
        tried = pairs + singles
        standing = [candidate for candidate in pairs if candidate.adequate(level)]
    verdict, standing, probabilities = _judge(standing)
    if verdict == "identified" and not base.fit.errors.noise.replicated:
        verdict = "ambiguous"
    return Diagnosis(verdict, base, standing, probabilities, [*tried, base])


def _refine_best(search: Search, fits: list[Fit], report: Callable[[str], None]) -> list[Candidate]:
    """Put the fits near the best on the forward model; return all, best first."""
    fits = sorted(fits, key=lambda fit: -fit.log_evidence)
    done = []
    for k, fit in enumerate(fits):
        if k < MOST_REFINED and (k == 0 or fit.log_evidence > fits[0].log_evidence - SCREENED):
            candidate = search.refined(fit)
            report(
                f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}, on the forward model "
                f"{candidate.fit.log_evidence:.1f}, p = {candidate.examination.p_value:.3g}"  # type: ignore[union-attr]
            )
        else:
            candidate = Candidate(fit)
            report(f"{'+'.join(fit.explanation)}: log evidence {fit.log_evidence:.1f}")
        done.append(candidate)
    return sorted(done, key=lambda candidate: -candidate.fit.log_evidence)


def _pairs(singles: list[Candidate], keys: list[str]) -> list[tuple[Fit, str]]:
    """Return the pairs that promise the greatest evidence: that of one, plus what filters see of the other."""
    promised: dict[frozenset[str], tuple[float, Fit, str]] = {}
    for candidate, key in itertools.product(singles, keys):
        if candidate.examination is None or key in candidate.fit.explanation:
            continue
        score = candidate.fit.log_evidence + 0.5 * candidate.examination.scores.get(key, 0.0)
        pair = frozenset((*candidate.fit.explanation, key))
        if pair not in promised or score > promised[pair][0]:
            promised[pair] = score, candidate.fit, key
    return [(fit, key) for _, fit, key in sorted(promised.values(), key=lambda entry: -entry[0])[:MOST_PAIRS]]


def _judge(standing: list[Candidate]) -> tuple[str, list[Candidate], list[float]]:
    """Return the verdict, the explanations within the likelihood ratio of the best, and their probabilities."""
    if not standing:
        return "unexplained", [], []
    evidence = np.array([candidate.fit.log_evidence for candidate in standing])
    weights = np.exp(evidence - evidence.max())
    kept = evidence >= evidence.max() - CLOSE
    probabilities = (weights / weights.sum())[kept]
    chosen = [candidate for candidate, keep in zip(standing, kept, strict=True) if keep]
    return ("identified" if len(chosen) == 1 else "ambiguous"), chosen, probabilities.tolist()
