"""Fits of mechanisms with the material, on the finite elements.

A fit begins at the screened effects of least misfit, and is weighed as by calibration. Where it comes near to what
noise leaves it goes on with the model of record, known there, weighed by the noise of the recordings alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.configuration.study_file import Study
from palpate.diagnosis.constraints import contradicted
from palpate.diagnosis.detect import examine
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.screen import Screen
from palpate.errors import PalpateError
from palpate.inference.amplitude import Amplitude, own_amplitudes
from palpate.inference.amplitude_constraint import AmplitudeConstraint, departures
from palpate.inference.covariance import Errors, errors, noise_of
from palpate.inference.explanation import Fit
from palpate.inference.forward import Forward
from palpate.inference.least_squares import Misfit
from palpate.inference.noise import NoiseModel
from palpate.inference.problem import Explanation, Problem
from palpate.inference.trust_region import Descent, descend, resumed
from palpate.mechanisms import MECHANISMS

LawsBeside = Callable[[Fit], Sequence[AmplitudeConstraint]]
OWN_VALUES = (0.0, 0.01, 0.03, 0.1, 0.3)  # of the largest value: by how much it may differ between conditions
LEAST_GAIN = 2.0  # of the logarithm of the likelihood, by which a difference between conditions is taken to be there


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
    starts
        Where the base model may lie: materials by the names of their parameters.
    laws
        Returns what exact laws say about amplitudes beside a fit of the base model.

    Attributes
    ----------
    study, policy
        Settings.
    problem
        The recordings, with the forward model of record.
    base
        The base model.
    screen
        What mechanisms would add to it.
    """

    def __init__(
        self,
        study: Study,
        problem: Problem,
        keys: Sequence[str],
        rng: np.random.Generator,
        starts: Sequence[Mapping[str, float]],
        laws: LawsBeside | None = None,
        policy: SearchPolicy | None = None,
    ):
        self.study, self.problem, self._rng = study, problem, rng
        self.policy = policy or SearchPolicy()
        self._laws: tuple[AmplitudeConstraint, ...] = ()
        self._take_for_noise(np.zeros(len(problem.mean)))
        begin = [problem.forward.coordinates.scaled(start) for start in starts]
        base = self._base(begin)
        self.screen = Screen.of(base, keys)
        if not problem.replicated:
            self._estimate_noise_without_replicates(base)
            base = self.fitted((), [base.z], base.curve)
        self._laws = tuple(laws(base)) if laws else ()
        self.base = self.examined(replace(base, laws=self._laws))

    def fitted(self, explanation: Explanation, starts: Sequence[np.ndarray], depth: np.ndarray) -> Fit:
        """Fit an explanation.

        Parameters
        ----------
        starts
            Coordinates (k,) from which searches begin.
        depth : ndarray, shape (n_all,)
            Curves that lie near [nm].

        Raises
        ------
        PalpateError
            When the forward model fails at all starts.
        """
        problem, policy = self.problem, self.policy
        model, about = problem.model(explanation), self._errors(explanation, starts[0], depth)
        misfit = self._misfit(explanation, about)
        limit, settled = policy.iterations, policy.settled
        end = descend(misfit, model, starts, limit, settled=policy.settled_at_first)
        weighed = self._errors(explanation, end.u, problem.stacked(end.curves), self._effects(explanation, end))
        fit = self._with_own_values(self._fit(explanation, model, end, weighed))
        if any(fit.errors.between.values()):
            end = descend(self._certain(fit), model, [end], limit, settled=settled, exact=False)
            fit = self._fit(explanation, model, end, fit.errors)
        if not self._near(fit):
            return fit
        model = model.of_record(end.u)
        end = resumed(self._certain(fit), model, end, limit, settled=settled, exact=False)
        return self._fit(explanation, model, end, fit.errors)

    def _base(self, starts: Sequence[np.ndarray]) -> Fit:
        """Return the fit of the base model to which a search with few samples leads, from coordinates (k,).

        Where the model of record fails at its end, the fit begins where the search last was without that.
        """
        problem, policy = self.problem, self.policy
        cheaper, keep = problem.forward.thinned()
        misfit = self._misfit((), self._errors((), starts[0], problem.mean), keep)
        way = descend(misfit, cheaper, starts, policy.iterations, settled=policy.settled_at_first, exact=False)
        failed = ""
        for place in [way.u, *reversed(way.path), *starts]:
            self.problem = replace(problem, forward=problem.forward.of_record(place))
            try:
                return self.fitted((), [place], problem.mean)
            except PalpateError as error:
                failed = str(error)
        raise PalpateError(failed)

    def _fit(self, explanation: Explanation, model: Forward, end: Descent, weighed: Errors) -> Fit:
        """Return the fit at which a search ended."""
        curve, tangent = self.problem.stacked(end.curves), self.problem.stacked(end.slopes)
        return Fit(self.problem, explanation, model, end.u, weighed, curve, tangent, self._laws)

    def _certain(self, fit: Fit) -> Misfit:
        """Return the misfit of a model that lacks nothing, by the errors of a fit."""
        return replace(self._misfit(fit.explanation, fit.errors), lacking=False)

    def joined(self, fit: Fit, key: str) -> Fit:
        """Fit an explanation and one more mechanism; raises as `fitted`."""
        several = self.screen.trials[key].shape[1] > 1
        starts = self.screen.starts(fit, key, self.policy.starts if several else 1)
        return self.fitted((*fit.explanation, key), starts, fit.curve)

    def neighbours(self, fit: Fit) -> list[Fit]:
        """Return a fit that is near to what noise leaves without each of its mechanisms in turn, where it lies."""
        problem, found = self.problem, []
        for key in fit.explanation if self._near(fit) else ():
            smaller, rest = problem.without(fit.explanation, fit.z, key)
            model, places = problem.model(smaller), problem.places(fit.explanation)[key]
            (curves,) = model.curves([rest])
            if not isinstance(curves, str):
                curve, tangent = problem.stacked(curves), np.delete(fit.tangent, places, axis=1)
                weighed = self._errors(smaller, rest, curve)
                found.append(Fit(problem, smaller, model, rest, weighed, curve, tangent, self._laws))
        return found

    def _near(self, fit: Fit) -> bool:
        """Return whether a fit is near to what noise leaves."""
        return float(fit.white @ fit.white) < self.policy.hopeless * len(fit.white)

    def examined(self, fit: Fit) -> Candidate:
        """Test what a fit leaves."""
        draws, scatter = self.study.diagnosis["bootstrap"], self.study.calibration["site_scatter"]
        left = examine(fit, self.screen, self._rng, draws, scatter)
        return Candidate(fit, left, tuple(contradicted(fit, self._laws)))

    def _misfit(
        self, explanation: Explanation, weighed: Errors, keep: Mapping[str, np.ndarray] | None = None
    ) -> Misfit:
        """Return how far curves lie from recorded ones, at the samples that are kept; by default at all."""
        problem = self.problem
        nm = {name: problem.nm.get(name, 1.0) for name in problem.names}
        keep = keep or {name: np.ones(len(problem.observed[name].time), dtype=bool) for name in problem.names}
        measured = {name: problem.observed[name].mean[keep[name]] / nm[name] for name in problem.names}
        kept = np.concatenate([keep[name] for name in problem.names])
        scale = np.concatenate([np.full(len(curve), nm[name]) for name, curve in measured.items()])
        covariance = weighed.covariance[np.ix_(kept, kept)] / np.outer(scale, scale)

        def from_laws(z: np.ndarray) -> np.ndarray:
            return departures(self._laws, problem.amplitudes(explanation, z))

        return Misfit(measured, covariance, nm, problem.coordinates(explanation), from_laws)

    def _effects(self, explanation: Explanation, end: Descent) -> dict[str, np.ndarray]:
        """Return what those mechanisms add to the curves (n_all,) [nm] at the end of a search whose effects err.

        The error of an effect with one amplitude is one of this: where the effect saturates, as friction's does once
        the surface sticks, that is another curve than the effect itself.
        """
        problem, found = self.problem, {}
        for key in [key for key in explanation if MECHANISMS[key].solver_scatter]:
            places = problem.places(explanation)[key]
            if len(places) == 1:
                ((name, neutral),) = MECHANISMS[key].neutral.items()
                value, slope = problem.quantity(explanation, end.u, f"{key}.{name}")
                found[key] = problem.stacked(end.slopes)[:, places[0]] * (value - neutral) / slope
                continue
            smaller, rest = problem.without(explanation, end.u, key)
            (without,) = problem.model(smaller).curves([rest])
            if not isinstance(without, str):
                found[key] = problem.stacked(end.curves) - problem.stacked(without)
        return found

    def _with_own_values(self, fit: Fit) -> Fit:
        """Let amplitudes that vary differ between conditions, too, by as much as is likeliest."""
        for amplitude in fit.own:
            best, chosen = -np.inf, fit
            for share in OWN_VALUES:
                between = {**fit.errors.between, str(amplitude): (share * fit.problem.largest(amplitude)) ** 2}
                trial = replace(fit, errors=replace(fit.errors, between=between))
                tangent = trial.whiten(fit.tangent)
                left = trial.white - tangent @ np.linalg.lstsq(tangent, trial.white, rcond=1e-10)[0]
                likelihood = -0.5 * float(left @ left) - trial.log_volume
                if likelihood > best + LEAST_GAIN * (share > 0 and best > -np.inf):
                    best, chosen = likelihood, trial
            fit = chosen
        return fit

    def _errors(
        self,
        explanation: Explanation,
        z: np.ndarray,
        depth: np.ndarray,
        effects: Mapping[str, np.ndarray] | None = None,
    ) -> Errors:
        """Return the errors of the mean curves about `depth` (n_all,) [nm], with the amplitudes at coordinates z."""
        calibration = self.study.calibration
        own = own_amplitudes(self.problem.amplitudes(explanation, z)) if explanation else ()
        if own not in self._noise:
            self._noise[own] = noise_of(self.problem, own, self._residual_as_noise, calibration["site_scatter"])
        return errors(self.problem, own, depth, self._noise[own], calibration["solver_error"], effects)

    def _estimate_noise_without_replicates(self, base: Fit) -> None:
        """Take for noise, without replicates, what the fit leaves that leaves least beside slow trends.

        One that fits worse would allow itself more noise, but what is compared has to be measured by the same. To first
        order, sets grow from the base model as long as one more mechanism makes what is left much likelier.
        """
        likeliest, best = base, self._residual_log_likelihood(base.residual)
        for _ in range(self.study.diagnosis["largest_set"]):
            self._take_for_noise(likeliest.residual)
            likeliest = replace(likeliest, errors=self._errors((), likeliest.z, likeliest.curve))
            wider = [self.screen.taken_off(likeliest, key) for key in self.screen.keys]
            likely = [self._residual_log_likelihood(fit.residual) - self.policy.mechanism_penalty for fit in wider]
            if max(likely, default=-np.inf) <= best:
                break
            likeliest = wider[int(np.argmax(likely))]
            best = self._residual_log_likelihood(likeliest.residual)
        self._take_for_noise(likeliest.residual)

    def _take_for_noise(self, residual: np.ndarray) -> None:
        """Take a residual (n_all,) for noise where most conditions are not repeated."""
        self._residual_as_noise = residual
        self._noise: dict[tuple[Amplitude, ...], NoiseModel] = {}

    def _residual_log_likelihood(self, residual: np.ndarray) -> float:
        """Return the logarithm of the likelihood of what is left (n_all,) beside slow trends."""
        return noise_of(self.problem, (), residual, self.study.calibration["site_scatter"]).log_likelihood
