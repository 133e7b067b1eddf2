"""Explanations of one set of recordings: fitted with the material on the finite elements, and tested.

A mechanism that joins begins at the screened effects of least misfit, see `palpate.diagnosis.screen`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Event

import numpy as np
from scipy.optimize import minimize_scalar

from palpate.configuration.study_file import Study
from palpate.diagnosis.constraints import contradicted
from palpate.diagnosis.detect import examine
from palpate.diagnosis.locate import with_tolerable_law
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.screen import Screen
from palpate.errors import PalpateError
from palpate.inference.amplitude import Amplitude
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.covariance import noise_of
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.last_steps import on_finer_meshes, with_finer_curves
from palpate.inference.posterior import posterior_draws
from palpate.inference.problem import Explanation, Problem
from palpate.inference.starting_places import scattered
from palpate.mechanisms import MECHANISMS

SPREAD = np.linspace(0.0, 1.0, 13)  # places in the range of a parameter, of which the likeliest is refined
CLOSE = {"xatol": 0.01}  # of the range


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation that was fitted.

    Attributes
    ----------
    fit
        Its best parameters.
    examined
        Returns the p-value of what it leaves.
    contradicts
        The exact laws that its amplitudes contradict.
    """

    fit: Fit
    examined: Callable[[Fit], float]
    contradicts: tuple[AmplitudeConstraint, ...] = ()

    @cached_property
    def p_value(self) -> float:
        """Of what it leaves being noise, error of the mesh and a tolerable discrepancy of the law."""
        return self.examined(self.fit)

    @cached_property
    def draws(self) -> np.ndarray:
        """Draws (m, k) from its posterior, see `palpate.inference.posterior`."""
        return posterior_draws(self.fit)

    @property
    def rank(self) -> tuple[bool, float]:
        """What is compared between fits of one set: one that contradicts no exact law, then the likeliest."""
        return not self.contradicts, self.fit.log_evidence

    def within(self, tolerance: float, significance: float) -> float:
        """Return the probability that the law departs by no more than a tolerance [-].

        Where the law is taken to be exact, it is one if the p-value reaches the significance, and zero else.
        """
        if self.fit.errors.law is None:
            return float(self.p_value >= significance)
        return self.fit.within(tolerance)


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
        laws: Callable[[Fit], Sequence[AmplitudeConstraint]] | None = None,
        policy: SearchPolicy | None = None,
    ):
        self.study = study
        self.policy = policy or SearchPolicy()
        given = study.calibration
        self._fitter = Fitter(problem, given.site_scatter, given.solver_error, given.law_error)
        self._shown_by_replicates: dict[str, tuple[float, tuple[Amplitude, ...]]] = {}
        known = [problem.forward.coordinates.scaled(calibrated)] if calibrated else []
        starts = known or scattered(problem.material, self._fitter.policy, rng)
        if problem.replicated:
            base = self._fitter.base(starts)
        else:
            base = self._fitter.at(*known) if known else self._fitter.reweighed(self._fitter.closest(starts))
        if self._fitter.explains(base):
            base = on_finer_meshes(self._fitter, base)
        elif base.errors.law is None:
            base = with_finer_curves(self._fitter, base)
        base = self._fitter.use_as_reference(base)
        self.problem = base.problem
        self.screen = Screen.of(base, keys, self.policy.threads)
        if not problem.replicated:
            self._estimate_noise_without_replicates(base)
            base = replace(base, errors=self._fitter.errors((), base.model, base.z, base.curve)).sized()
        self._fitter.constraints = tuple(laws(base)) if laws else ()
        self.base = self.candidate(replace(base, constraints=self._fitter.constraints))

    def fitted(self, explanation: Explanation, starts: Sequence[np.ndarray], depth: np.ndarray) -> Fit:
        """Fit an explanation, see `palpate.inference.fitting.Fitter.fitted`."""
        return self._fitter.fitted(explanation, starts, depth)

    def joined(self, fit: Fit, key: str, stop: Event | None = None) -> Fit:
        """Fit an explanation and one more mechanism, with the references of the smaller one, see `fitted`.

        A model without an effect that is there may have its optimum far outside the ranges, and so lead its successors
        there. Where such a smaller one ended there, the search begins within them; where this one ends there, or far
        from the recordings and less likely than to first order, it is fitted once more from the other places, and the
        likelier of both is taken.
        """
        model = fit.model.joined([MECHANISMS[key]], self.problem.scale)
        middle = np.where(fit.coordinates.beyond(fit.z) == 0.0, fit.z, 0.5)
        places, outside = [self._starts(fit, key)], self._ends_outside(fit)
        if not self._fitter.explains(fit):
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
            short = outside and self._fitter.falls_short(found[-1])
            behind = short and found[-1].log_evidence < self.log_evidence(fit, key) - self.policy.rough
            if not (behind or self._ends_outside(found[-1])):
                break
        if not found:
            raise PalpateError(failed)
        return max(found, key=lambda each: each.log_evidence)

    def _starts(self, fit: Fit, key: str) -> list[np.ndarray]:
        """Return where searches may begin once a mechanism joins, see `palpate.diagnosis.screen.Screen.starts`.

        The mean of an effect that averages out does not tell its further parameter; the replicates do.
        """
        starts = self.screen.starts(fit, key)
        if MECHANISMS[key].averages_out and self.problem.replicated:
            place = len(fit.z) + self.problem.place((key,), _beside(key)) - self.problem.material
            for start in starts:
                start[place] = self._by_replicates(key)[0]
        return starts

    def _by_replicates(self, key: str) -> tuple[float, tuple[Amplitude, ...]]:
        """Return where replicates differ most as by a mechanism that averages out.

        That is the coordinate of the parameter beside its amplitudes, by a search of the likelihood of the noise, and
        the amplitudes there.
        """
        if key not in self._shown_by_replicates:
            problem = self.problem
            coordinate = problem.coordinates((key,)).free[problem.place((key,), _beside(key))]
            name = _beside(key).split(".")[1]

            def amplitudes(place: float) -> tuple[Amplitude, ...]:
                return Amplitude.of(key, {**MECHANISMS[key].neutral, name: float(coordinate.physical(place))})

            def unlikely(place: float) -> float:
                return -self._noise_log_likelihood(problem.mean, amplitudes(place))

            best = min(SPREAD, key=unlikely)
            step = float(SPREAD[1] - SPREAD[0])
            found = minimize_scalar(unlikely, bounds=(best - step, best + step), method="bounded", options=CLOSE)
            self._shown_by_replicates[key] = float(found.x), amplitudes(float(found.x))
        return self._shown_by_replicates[key]

    def _reach(self, fit: Fit, key: str) -> float:
        """Return the chi-square that a fit must reach once a mechanism has joined.

        Noise may leave it, and it is lower than before; not so for a mechanism that varies, which explains replicates,
        nor where the law's discrepancy has another size than before.
        """
        likely = self._fitter.policy.likely_chi_square(len(fit.white))
        return likely if MECHANISMS[key].varies or fit.errors.law else min(likely, fit.misfit)

    def _ends_outside(self, fit: Fit) -> bool:
        """Return whether a fit ended far outside the ranges."""
        return bool(np.abs(fit.coordinates.beyond(fit.z)).max() > self.policy.outside)

    def followed(self, candidate: Candidate) -> Candidate:
        """Return an explanation whose search was given up after it has gone on, if that made it likelier.

        It goes on where the forward model does not fail, see `palpate.inference.fitting.Fitter.fitted`.
        """
        fit = candidate.fit
        try:
            again = self._fitter.fitted(fit.explanation, [fit.z], fit.curve, fit.model, reach=np.inf)
        except PalpateError:
            return candidate
        return self.candidate(again) if again.log_evidence > fit.log_evidence else candidate

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
                found.append(Fit(problem, smaller, model, rest, weighed, curve, tangent, fit.constraints))
        return found

    def candidate(self, fit: Fit) -> Candidate:
        """Return a fit as an explanation."""
        return Candidate(fit, self._p_value, tuple(contradicted(fit, fit.constraints)))

    def _p_value(self, fit: Fit) -> float:
        """Test what a fit leaves, with the same draws for all."""
        settings, scatter = self.study.diagnosis, self.study.calibration.site_scatter
        rng, tolerable = np.random.default_rng([self.study.seed, 2]), with_tolerable_law(fit, settings.tolerance)
        return examine(tolerable, self.screen, rng, settings.bootstrap, scatter)

    def log_evidence(self, fit: Fit, key: str) -> float:
        """Return the log evidence once a mechanism joins a fit, to first order.

        Where its amplitudes differ between recordings, replicates tell as well. An exact law about the mechanism, or
        one that it breaks, is satisfied at best.
        """
        problem, mechanism = self.problem, MECHANISMS[key]
        found = self.screen.log_evidence(fit, key)
        if mechanism.varies and problem.replicated:
            own = self._by_replicates(key)[1] if mechanism.averages_out else problem.typical(key)
            found += self._noise_log_likelihood(fit.residual, own) - self._noise_log_likelihood(fit.residual)
        broken = [not law.holds_under((*fit.explanation, key)) for law in fit.constraints]
        about = [law.key in (key, *mechanism.includes) for law in fit.constraints]
        return found + 0.5 * float(fit.constraint_misfits @ np.logical_or(broken, about))

    def _estimate_noise_without_replicates(self, base: Fit) -> None:
        """Estimate the noise from the residual of the best-fitting set of mechanisms, less slow trends.

        A worse fit would estimate more noise, but explanations have to be compared with the same noise. To first order,
        mechanisms are added to the base model as long as one more raises the log-likelihood of the residual by more
        than its penalty.
        """
        fitter, likeliest, best = self._fitter, base, self._noise_log_likelihood(base.residual)
        for _ in range(self.study.diagnosis.largest_set):
            fitter.use_residual_as_noise(likeliest.residual)
            weighed = fitter.errors((), likeliest.model, likeliest.z, likeliest.curve)
            likeliest = replace(likeliest, errors=weighed)
            wider = [self.screen.with_effect(likeliest, key) for key in self.screen.keys]
            likely = [self._noise_log_likelihood(fit.residual) for fit in wider]
            if max(likely, default=-np.inf) - self.policy.mechanism_penalty <= best:
                break
            likeliest, best = wider[int(np.argmax(likely))], max(likely)
        fitter.use_residual_as_noise(likeliest.residual)

    def _noise_log_likelihood(self, residual: np.ndarray, own: tuple[Amplitude, ...] = ()) -> float:
        """Return the log-likelihood of replicates, or of a residual (n_all,) less slow trends, as noise.

        Each recording has amplitudes of its `own`.
        """
        return noise_of(self.problem, own, residual, self.study.calibration.site_scatter).log_likelihood


def _beside(key: str) -> str:
    """Return the one parameter of a mechanism, ``key.name``, that is no amplitude."""
    (name,) = (p.name for p in MECHANISMS[key].parameters if p.name not in MECHANISMS[key].amplitudes)
    return f"{key}.{name}"
