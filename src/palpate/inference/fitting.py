"""Fits of an explanation, material and mechanisms together, to the recordings on a forward model.

A fit is weighted by the noise of the recordings, estimated from replicates, by the error of the solver, and by the
discrepancy of the law, whose size is that which is likeliest where the search arrives, the parameters integrated over
(`palpate.inference.discrepancy`). What is left far from there counts as a remainder, see
`palpate.inference.least_squares`. Where a fit comes near to what these errors leave it goes on with the model of
record, known there, without a remainder. The explanation without a mechanism is the base model: a calibration fits it,
and a diagnosis begins with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from threading import Event

import numpy as np

from palpate.data.noise import NoiseModel
from palpate.errors import PalpateError
from palpate.inference.amplitude import Amplitude, own_amplitudes
from palpate.inference.amplitude_constraint import AmplitudeConstraint, departures
from palpate.inference.covariance import Errors, errors, noise_of, of_mesh
from palpate.inference.discrepancy import Size
from palpate.inference.errors_at_end import effects_at, with_individual_amplitudes
from palpate.inference.explanation import Fit
from palpate.inference.fit_policy import FitPolicy
from palpate.inference.least_squares import Misfit, by_misfit
from palpate.inference.problem import Explanation, Problem
from palpate.inference.search_state import SearchState, StoppingCriteria
from palpate.inference.starting_places import places
from palpate.inference.trust_region import LEAST_STEPS, continued, descend
from palpate.models.forward import Forward


@dataclass(eq=False)
class Fitter:
    """Fits explanations of one set of recordings.

    Parameters
    ----------
    problem
        The recordings, and a forward model: from the first fit of the base model on that of record, near that fit.
    site_scatter
        Assumed scatter of the depth between sites [-], where at most half of the conditions are repeated.
    solver_error
        Relative error of grid convergence of the forward model, standard deviation [-].
    law_error
        Median of the prior of the law's discrepancy [-]; 0 where the law is taken to be exact.
    policy
        How far a fit goes.
    constraints
        Amplitudes given by exact laws; they are data as well.
    """

    problem: Problem
    site_scatter: float
    solver_error: float
    law_error: float = 0.0
    policy: FitPolicy = field(default_factory=FitPolicy)
    constraints: tuple[AmplitudeConstraint, ...] = ()
    _residual_as_noise: np.ndarray = field(init=False, repr=False)
    _noise: dict[tuple[Amplitude, ...], NoiseModel] = field(init=False, repr=False)
    _size: Size | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        self.use_residual_as_noise(np.zeros(len(self.problem.mean)))

    def base(self, starts: Sequence[np.ndarray]) -> Fit:
        """Fit the base model from coordinates (k,).

        Of several starts the best are followed first by searches with few samples. The fit begins at the end of these
        or, where the model of record fails there, at the last place on the way where it does not.

        Raises
        ------
        PalpateError
            When the forward model fails at all starts.
        """
        problem, failed = self.problem, ""
        cheaper, keep = problem.forward.thinned()
        misfit = self._misfit((), self.errors((), problem.forward, starts[0], problem.mean), keep)
        for place in places(misfit, cheaper, starts, self.policy):
            self.problem = replace(problem, forward=problem.forward.reanchored(place))
            try:
                fit = self.fitted((), [place], problem.mean)
            except PalpateError as error:
                self.problem, failed = problem, str(error)
                continue
            return self.use_as_reference(fit)
        raise PalpateError(failed)

    def closest(self, starts: Sequence[np.ndarray]) -> Fit:
        """Fit the base model from coordinates (k,) as close to the curves as it comes, as if there were no error.

        Without replicates noise cannot be distinguished from misfit, and what this fit leaves beside slow trends is
        taken for noise; no factor of a site or of the solver is free. Raises as `base`.
        """
        exact = replace(self, site_scatter=0.0, solver_error=0.0, law_error=0.0)
        fit = exact.base(starts)
        self.problem = exact.problem
        return fit

    def at(self, z: np.ndarray) -> Fit:
        """Return the base model of single recordings at coordinates (k,) at which an earlier search of it has ended.

        What it leaves there beside slow trends is taken for noise.

        Raises
        ------
        PalpateError
            When the forward model fails there.
        """
        model = self.problem.forward.reanchored(z)
        (found,) = model.tangents([z])
        if isinstance(found, str):
            raise PalpateError(found)
        curve, tangent = map(self.problem.stacked, found)
        self.use_residual_as_noise(self.problem.mean - curve)
        weighed = self.errors((), model, z, curve)
        return Fit(self.problem, (), model, z, weighed, curve, tangent, self.constraints).sized()

    def fitted(
        self,
        explanation: Explanation,
        starts: Sequence[np.ndarray],
        depth: np.ndarray,
        model: Forward | None = None,
        stop: Event | None = None,
        reach: float | None = None,
    ) -> Fit:
        """Fit an explanation; a search is given up that is not expected to reach what it must.

        Parameters
        ----------
        starts
            Coordinates (k,) from which searches may begin, that of least expected misfit first.
        depth : ndarray, shape (n_all,)
            Curves that lie near [nm].
        model
            Forward model of the explanation; by default with the references of the base model.
        stop
            Ends the fit once it is set.
        reach
            Chi-square that it must reach; by default the largest that noise may leave, and any for the base model.

        Raises
        ------
        PalpateError
            When the forward model fails at all starts.
        CancelledError
            When the fit was stopped.
        """
        problem, policy, model = self.problem, self.policy, model or self.problem.model(explanation)
        misfit = self._misfit(explanation, self.errors(explanation, model, starts[0], depth))
        limit = policy.iterations if explanation else policy.base_iterations
        if reach is None:
            reach = policy.likely_chi_square(len(problem.mean)) if explanation else np.inf
        until = StoppingCriteria(
            limit, policy.first_tolerance, True, stop, reach, policy.first_tolerance if explanation else 0.0
        )
        begun = starts if explanation else self._with_slopes(misfit, model, starts)
        end = begun[0]
        if not (isinstance(end, SearchState) and self._begins_near(model, end)):
            end = self._searched(misfit, model, begun, depth, until)
        effects = effects_at(problem, explanation, end)
        weighed = self.errors(explanation, model, end.u, end.curve, effects)
        fit = with_individual_amplitudes(self.at_end(explanation, model, end, weighed)).sized()
        if explanation and fit.misfit_ratio > policy.refined:
            return fit
        tolerance = policy.tolerance * (max(fit.misfit_ratio, 1.0) if explanation else 1.0)
        until = replace(until, tolerance=tolerance, exact=not (explanation or problem.replicated))
        if any(fit.errors.between.values()):
            end = descend(self.goal(fit), model, [end], until)
            fit = self.at_end(explanation, model, end, fit.errors)
        record = model.reanchored(end.u)
        if record is model:
            fit, goal = self._weighed_by(fit, model, misfit)
            end = descend(goal, model, [end], until)
            record = model.reanchored(end.u)
        if record is not model:
            fit, goal = self._weighed_by(fit, record, misfit)
            end = continued(goal, record, end, until)
        return self.settled(self.at_end(explanation, record, end, fit.errors), until)

    def settled(self, fit: Fit, until: StoppingCriteria) -> Fit:
        """Return a fit after the size of the law's discrepancy and the parameters agree.

        The size mostly changes little from where a search ended. Where it was that of a model without an effect that
        is there, it hides what the search has to find, and falls from one search to the next.
        """
        for _ in range(self.policy.sizes):
            again = fit.sized()
            if again is fit or not self.near(again) or again.alike(fit):
                return again
            begun = SearchState(fit.z, fit.curve, fit.tangent, exact=False)
            end = descend(self.goal(again), fit.model, [begun], until)
            fit = self.at_end(fit.explanation, fit.model, end, again.errors)
        return fit.sized()

    def reweighed(self, fit: Fit) -> Fit:
        """Return a `closest` fit by the errors of these settings, its residual taken as noise, after a further search.

        The closest fit may lie far away, so the curves at the end are those of a forward model that is known there.
        """
        self.use_residual_as_noise(fit.residual)
        fit = replace(fit, errors=self.errors((), fit.model, fit.z, fit.curve))
        if not self.law_error:
            return fit
        fit = self.settled(fit, StoppingCriteria(self.policy.base_iterations, self.policy.tolerance))
        try:
            return replace(self.at(fit.z), converged=fit.converged)
        except PalpateError:
            return fit

    def _weighed_by(self, fit: Fit, record: Forward, usual: Misfit) -> tuple[Fit, Misfit]:
        """Return a fit with the error of a model's mesh, and its misfit by that; the `usual` one far from the noise."""
        fit = replace(fit, errors=replace(fit.errors, refinements=of_mesh(self.problem, record, self.solver_error)))
        return fit, self.goal(fit) if self.near(fit) else usual

    def _with_slopes(
        self, misfit: Misfit, model: Forward, starts: Sequence[np.ndarray]
    ) -> Sequence[np.ndarray | SearchState]:
        """Return the places to start, a single one with its derivatives where the model does not fail."""
        found = misfit.tangents(model, starts)[0] if len(starts) == 1 else ""
        return starts if isinstance(found, str) else [SearchState(starts[0], *found)]

    def _begins_near(self, model: Forward, begun: SearchState) -> bool:
        """Return whether a search of the base model begins near to what noise leaves already."""
        errors = self.errors((), model, begun.u, begun.curve)
        return self.near(self.at_end((), model, begun, errors))

    def goal(self, fit: Fit) -> Misfit:
        """Return the misfit of a model without a remainder, by the errors of a fit."""
        return replace(self._misfit(fit.explanation, fit.errors), allow_remainder=False)

    def at_end(self, explanation: Explanation, model: Forward, end: SearchState, weighed: Errors) -> Fit:
        """Return the fit at which a search ended.

        Parameters
        ----------
        explanation, model
            Its mechanisms and forward model.
        end
            The search.
        weighed
            The errors of the mean curves.
        """
        found = end.u, weighed, end.curve, end.tangent, self.constraints, end.converged
        return Fit(self.problem, explanation, model, *found)

    def use_as_reference(self, base: Fit) -> Fit:
        """Let other explanations rest on the forward model of a fit of the base model, and return that."""
        self.problem, self._noise = replace(self.problem, forward=base.model, at=base.z), {}
        law = base.errors.law
        self._size = replace(law.size, share=min(law.share, self.law_error)) if law else None
        return replace(base, problem=self.problem)

    def explains(self, fit: Fit) -> bool:
        """Return whether a fit leaves so little that the error of the mesh may be part of it."""
        law = fit.errors.law
        within = law is None or law.share <= self.policy.finer_share
        return within and fit.misfit_ratio <= self.policy.finer_meshes

    def falls_short(self, fit: Fit) -> bool:
        """Return whether a fit leaves so much that its parameters cannot be those of the recordings."""
        law = fit.errors.law
        return fit.misfit_ratio > self.policy.refined or (law is not None and law.share > self.policy.finer_share)

    def near(self, fit: Fit) -> bool:
        """Return whether a fit is near to what noise leaves."""
        return float(fit.white @ fit.white) < self.policy.poor_fit * len(fit.white)

    def errors(
        self,
        explanation: Explanation,
        model: Forward,
        z: np.ndarray,
        depth: np.ndarray,
        effects: Mapping[str, np.ndarray] | None = None,
    ) -> Errors:
        """Return the errors of the mean curves about `depth` (n_all,) [nm], with the amplitudes at coordinates z.

        Parameters
        ----------
        explanation, model, z
            Mechanisms, forward model and coordinates (k,) of the explanation.
        depth : ndarray, shape (n_all,)
            Simulated curves [nm].
        effects
            What mechanisms add to the curves (n_all,) [nm], where it is known.
        """
        own = own_amplitudes(self.problem.amplitudes(explanation, z)) if explanation else ()
        if own not in self._noise:
            self._noise[own] = noise_of(self.problem, own, self._residual_as_noise, self.site_scatter)
        noise, known = self._noise[own], (self.solver_error, effects, self.law_error)
        found = errors(self.problem, model, own, depth, noise, *known)
        return replace(found, law=found.law.sized(self._size)) if found.law and self._size else found

    def use_residual_as_noise(self, residual: np.ndarray) -> None:
        """Take a residual (n_all,) [nm] for noise where at most half of the conditions are repeated."""
        self._residual_as_noise, self._noise = residual, {}

    def _searched(
        self,
        misfit: Misfit,
        model: Forward,
        starts: Sequence[np.ndarray | SearchState],
        depth: np.ndarray,
        until: StoppingCriteria,
    ) -> SearchState:
        """Return the best end of searches from some coordinates (k,).

        As many starts as run in the time of one are simulated together, and searches begin at the best of them. Further
        starts are taken as long as no search ends with a misfit about as small as that of `depth`.

        Parameters
        ----------
        misfit, model
            Misfit of the explanation, and its forward model.
        starts
            That of least expected misfit first.
        depth : ndarray, shape (n_all,)
            Curves of the smaller explanation [nm].
        until
            See `palpate.inference.trust_region.descend`, as the errors that are raised.
        """
        left, places = depth - self.problem.mean, [start for start in starts if not isinstance(start, SearchState)]
        batch = model.points_per_batch(places[0]) if len(places) > 1 else 1
        most = max(1, min(self.policy.searches, batch // LEAST_STEPS))
        weights = misfit.weights(misfit.remainder(left))
        good = float(np.sum((weights @ left) ** 2)) + self.policy.without_effect
        ends, failed = list[tuple[float, SearchState]](), ""
        for first in range(0, len(starts), batch):
            some = starts[first : first + batch]
            if len(some) > most:
                some = [u for _, u in by_misfit(misfit, weights, model, places[first : first + batch])[:most]]
            try:
                end = descend(misfit, model, some, until)
            except PalpateError as error:
                failed = str(error)
                continue
            ends.append((misfit.chi_square(end.curve, end.u, weights), end))
            if ends[-1][0] <= good:
                break
        if not ends:
            raise PalpateError(failed)
        return min(ends, key=lambda each: each[0])[1]

    def _misfit(
        self, explanation: Explanation, weighed: Errors, keep: Mapping[str, np.ndarray] | None = None
    ) -> Misfit:
        """Return how far curves lie from recorded ones, at the samples that are kept; by default at all."""
        problem = self.problem
        every = {name: np.ones(len(problem.observed[name].time), dtype=bool) for name in problem.names}
        kept = np.concatenate([(keep or every)[name] for name in problem.names])
        covariance = weighed.covariance[np.ix_(kept, kept)]

        def from_constraints(z: np.ndarray) -> np.ndarray:
            from_laws = departures(self.constraints, problem.amplitudes(explanation, z))
            return np.append(from_laws, problem.bulk_departures(explanation, z))

        coordinates = problem.coordinates(explanation)
        return Misfit(problem.mean[kept], covariance, problem.stacked, coordinates, from_constraints)
