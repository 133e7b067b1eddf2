"""Explanations that are tried: fits of mechanisms with the material, on surrogates and on the forward model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.config import Study
from palpate.diagnosis.correction import Correction
from palpate.diagnosis.covariance import Errors, errors, noise_of, varying
from palpate.diagnosis.detect import examine, excess
from palpate.diagnosis.fit import Fit, solve, starting_points
from palpate.diagnosis.law import Law
from palpate.diagnosis.laws import contradicted
from palpate.diagnosis.noise import NoiseModel
from palpate.diagnosis.problem import Explanation, Problem
from palpate.diagnosis.refine import hopeless, refine
from palpate.diagnosis.sharpen import sharpen
from palpate.errors import PalpateError

LawsBeside = Callable[[Fit], Sequence[Law]]

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
        """Take a residual (n_all,) for noise where most conditions are not repeated."""
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

    def settled(self, fit: Fit) -> Fit:
        """Return a fit at its optimum, by the surrogates' slopes: what it can make up for is made up for."""
        return solve(self._problem, fit.explanation, fit.errors, [fit.z], fit.correction, laws=self._laws)

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
