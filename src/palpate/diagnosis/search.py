"""Explanations of one set of recordings: fitted with the material on the finite elements, and tested.

A mechanism that joins begins at the screened effects of least misfit, see `palpate.diagnosis.screen`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from threading import Event

import numpy as np

from palpate.configuration.study_file import Study
from palpate.diagnosis.constraints import contradicted
from palpate.diagnosis.detect import examine, replicates_differ
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.screen import Screen
from palpate.errors import PalpateError
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.covariance import noise_of
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.last_steps import on_finer_meshes, with_finer_curves
from palpate.inference.problem import Explanation, Problem
from palpate.mechanisms import MECHANISMS

LawsBeside = Callable[[Fit], Sequence[AmplitudeConstraint]]


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation that was fitted.

    Attributes
    ----------
    fit
        Its best parameters.
    p_value
        Of what it leaves being noise.
    contradicts
        The exact laws that its amplitudes contradict.
    """

    fit: Fit
    p_value: float
    contradicts: tuple[AmplitudeConstraint, ...] = ()

    def adequate(self, significance: float) -> bool:
        """Return whether nothing but noise is left and no exact law is contradicted."""
        return self.p_value >= significance and not self.contradicts


class Search:
    """Fits explanations of one set of recordings.

    Parameters
    ----------
    calibrated
        Parameters of the calibrated base model, by name; by default it is searched for over the ranges.
    laws
        Returns the amplitudes that exact laws give, from a fit of the base model.

    Attributes
    ----------
    study, policy
        Settings.
    problem
        The recordings, with the forward model of record.
    base
        The base model.
    screen
        Effects of mechanisms at its optimum.
    """

    def __init__(
        self,
        study: Study,
        problem: Problem,
        keys: Sequence[str],
        rng: np.random.Generator,
        calibrated: Mapping[str, float] | None = None,
        laws: LawsBeside | None = None,
        policy: SearchPolicy | None = None,
    ):
        self.study, self._rng = study, rng
        self.policy = policy or SearchPolicy()
        errors = (study.calibration[name] for name in ("site_scatter", "solver_error", "law_error"))
        self._fitter = Fitter(problem, *errors)
        known = [problem.forward.coordinates.scaled(calibrated)] if calibrated else []
        base = self._fitter.base(known or self._fitter.scattered(rng))
        refined = on_finer_meshes if self.explains(base) else with_finer_curves
        base = self._fitter.rest_on(refined(self._fitter, base))
        self.problem = base.problem
        self.screen = Screen.of(base, keys, self.policy.threads)
        if not problem.replicated:
            self._estimate_noise_without_replicates(base)
            base = self.fitted((), [base.z], base.curve)
        self._fitter.laws = tuple(laws(base)) if laws else ()
        self.base = self.examined(replace(base, laws=self._fitter.laws))

    def fitted(self, explanation: Explanation, starts: Sequence[np.ndarray], depth: np.ndarray) -> Fit:
        """Fit an explanation, see `palpate.inference.fitting.Fitter.fitted`."""
        return self._fitter.fitted(explanation, starts, depth)

    def joined(self, fit: Fit, key: str, stop: Event | None = None) -> Fit:
        """Fit an explanation and one more mechanism, with the references of the smaller one, see `fitted`.

        A model without an effect that is there may have its optimum far outside the ranges, and so lead its successors
        there. Where such a smaller one ended there, the search begins within them; where this one ends there or far
        from the recordings, it is fitted once more from the other places, and the likelier of both is taken.
        """
        model = fit.model.joined([MECHANISMS[key]], self.problem.scale)
        middle = np.where(fit.coordinates.beyond(fit.z) == 0.0, fit.z, 0.5)
        places, outside = [self.screen.starts(fit, key)], self._ends_outside(fit)
        if not self.explains(fit):
            places.insert(0 if outside else 1, [np.append(middle, self.screen.place_shown(key))])
        found, failed, reach = list[Fit](), "", self._reach(fit, key)
        for starts in places:
            try:
                found.append(self._fitter.fitted((*fit.explanation, key), starts, fit.curve, model, stop, reach))
            except PalpateError as error:
                failed = str(error)
                if not outside:
                    break
                continue
            far = outside and found[-1].misfit_ratio > self._fitter.policy.refined
            if not (far or self._ends_outside(found[-1])):
                break
        if not found:
            raise PalpateError(failed)
        return max(found, key=lambda each: each.log_evidence)

    def _reach(self, fit: Fit, key: str) -> float:
        """Return the chi-square that a fit must reach once a mechanism has joined.

        Noise may leave it, and it is lower than before; not so for a mechanism that varies, which explains replicates.
        """
        likely = self._fitter.policy.likely_chi_square(len(fit.white))
        return likely if MECHANISMS[key].varies else min(likely, fit.misfit)

    def _ends_outside(self, fit: Fit) -> bool:
        """Return whether a fit ended far outside the ranges."""
        return bool(np.abs(fit.coordinates.beyond(fit.z)).max() > self.policy.outside)

    def finished(self, candidate: Candidate) -> Candidate:
        """Return an explanation whose fit went to its end, on finer meshes where it explains.

        A fit that was given up goes on where the forward model does not fail, see
        `palpate.inference.fitting.Fitter.fitted`, and the likelier end is taken.
        """
        fit = candidate.fit
        if fit.explanation and not fit.converged:
            with suppress(PalpateError):
                again = self._fitter.fitted(fit.explanation, [fit.z], fit.curve, fit.model, reach=np.inf)
                fit = max(fit, again, key=lambda each: each.log_evidence)
        fit = on_finer_meshes(self._fitter, fit)
        return candidate if fit is candidate.fit else self.examined(fit)

    def explains(self, fit: Fit) -> bool:
        """Return whether a fit leaves no more than noise and the error of the mesh may leave, by its chi-square."""
        return self._fitter.explains(fit)

    def neighbours(self, fit: Fit) -> list[Fit]:
        """Return a nearly adequate fit without each of its mechanisms in turn, at its coordinates."""
        problem, found = self.problem, []
        for key in fit.explanation if self._fitter.near(fit) else ():
            smaller, rest = problem.without(fit.explanation, fit.z, key)
            model, places = problem.model(smaller), problem.places(fit.explanation)[key]
            (curves,) = model.curves([rest])
            if not isinstance(curves, str):
                curve, tangent = problem.stacked(curves), np.delete(fit.tangent, places, axis=1)
                weighed = self._fitter.errors(smaller, model, rest, curve)
                found.append(Fit(problem, smaller, model, rest, weighed, curve, tangent, fit.laws))
        return found

    def examined(self, fit: Fit) -> Candidate:
        """Test what a fit leaves."""
        draws, scatter = self.study.diagnosis["bootstrap"], self.study.calibration["site_scatter"]
        left = examine(fit, self.screen, self._rng, draws, scatter)
        return Candidate(fit, left, tuple(contradicted(fit, fit.laws)))

    def cannot_leave_noise(self, fit: Fit, key: str) -> bool:
        """Return whether no fit of a mechanism that joins can leave noise, because replicates differ in another way."""
        level, scatter = self.study.diagnosis["significance"], self.study.calibration["site_scatter"]
        return not MECHANISMS[key].varies and replicates_differ(fit, self.screen.keys, scatter, level)

    def _estimate_noise_without_replicates(self, base: Fit) -> None:
        """Estimate the noise from the residual of the best-fitting set of mechanisms, less slow trends.

        A worse fit would estimate more noise, but explanations have to be compared with the same noise. To first order,
        mechanisms are added to the base model as long as one more raises the log-likelihood of the residual by more
        than its penalty.
        """
        fitter, likeliest, best = self._fitter, base, self._residual_log_likelihood(base.residual)
        for _ in range(self.study.diagnosis["largest_set"]):
            fitter.use_residual_as_noise(likeliest.residual)
            weighed = fitter.errors((), likeliest.model, likeliest.z, likeliest.curve)
            likeliest = replace(likeliest, errors=weighed)
            wider = [self.screen.with_effect(likeliest, key) for key in self.screen.keys]
            likely = [self._residual_log_likelihood(fit.residual) - self.policy.mechanism_penalty for fit in wider]
            if max(likely, default=-np.inf) <= best:
                break
            likeliest = wider[int(np.argmax(likely))]
            best = self._residual_log_likelihood(likeliest.residual)
        fitter.use_residual_as_noise(likeliest.residual)

    def _residual_log_likelihood(self, residual: np.ndarray) -> float:
        """Return the log-likelihood of a residual (n_all,) as noise, less slow trends."""
        return noise_of(self.problem, (), residual, self.study.calibration["site_scatter"]).log_likelihood
