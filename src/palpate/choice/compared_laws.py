"""Laws of one family under the same recordings: fits of each, what a law promises beside a fit, and their evidence.

All laws are judged with one noise, one error of the solver and one prior of the discrepancy
(`palpate.inference.discrepancy`), so that their log evidences can be subtracted. Their parameters have priors that are
even over the ranges which the recordings suggest without a simulation (`palpate.draft.guesses`).

A law that contains the base law, at neutral values of its further parameters, has the same curves there. Derivatives by
all of its parameters at that point give, to first order, the best fit that it can reach and its evidence: a score test
(C.R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50-57) with the discrepancy integrated over. It costs one simulation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.errors import PalpateError
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.problem import Problem
from palpate.inference.search_state import SearchState
from palpate.materials import law_of
from palpate.materials.first_guess import Guessed
from palpate.models.finite_elements import FiniteElements

Levels = Mapping[str, Sequence[float]]


def with_levels(study: Study, law: str, levels: Levels) -> Study:
    """Return a study with a law and levels of its parameters."""
    return replace(study, model=law_of(law).key, levels={name: tuple(row) for name, row in levels.items()})


@dataclass(frozen=True, eq=False)
class ComparedLaws:
    """Laws under one set of recordings.

    Parameters
    ----------
    study
        With any law.
    observed
        Of every condition.
    guessed
        Ranges of the parameters of each law, by its key.
    residual : ndarray, shape (n_all,)
        Of the base law [nm], from which the noise is estimated where no replicates give it.
    """

    study: Study
    observed: Mapping[str, Observation]
    guessed: Mapping[str, Mapping[str, Guessed]]
    residual: np.ndarray | None = None

    def problem(self, law: str) -> Problem:
        """Return the recordings with the finite elements of a law as the forward model."""
        levels = {name: found.values for name, found in self.guessed[law].items()}
        return Problem.of(with_levels(self.study, law, levels), self.observed)

    def middle(self, law: str) -> np.ndarray:
        """Return the coordinates (k,) of the middle of a law's ranges on a linear scale: all its terms act."""
        values = {name: float(np.mean(found.values)) for name, found in self.guessed[law].items()}
        return self.problem(law).forward.coordinates.scaled(values)

    def fit(self, law: str, starts: Sequence[np.ndarray]) -> Fit:
        """Fit a law from coordinates (k,); raises `PalpateError` where it fails at all of them.

        Without replicates the fit comes as close to the curves as it can, as that of a calibration does first.
        """
        problem = self.problem(law)
        settings = self._settings if problem.replicated else (0.0, 0.0, 0.0)
        return Fitter(problem, *settings).base(starts)

    def weighed(self, fit: Fit) -> Fit:
        """Return a fit with the errors by which laws are compared."""
        fitter = self._fitter(fit.problem)
        return replace(fit, errors=fitter.errors((), fit.model, fit.z, fit.curve)).sized()

    def promised(self, law: str, values: Mapping[str, float], base: Fit) -> Fit:
        """Return a law where it equals the base law, or nearly so; its evidence there is that of the best linear step.

        Parameters
        ----------
        law
            Its key.
        values
            Its parameters by name.
        base
            The fit of the base law.

        Raises
        ------
        PalpateError
            When it cannot be simulated there.
        """
        problem = self.problem(law)
        forward, like = problem.forward, base.model
        assert isinstance(forward, FiniteElements) and isinstance(like, FiniteElements)
        z = np.clip(forward.coordinates.scaled(values), *forward.coordinates.limits)
        model = forward.anchored_like(like, z)
        (found,) = model.tangents([z])
        if isinstance(found, str):
            raise PalpateError(found)
        end = SearchState(z, problem.stacked(found[0]), problem.stacked(found[1]))
        fitter = self._fitter(problem)
        return replace(fitter.at_end((), model, end, fitter.errors((), model, z, end.curve)), converged=True).sized()

    @cached_property
    def _settings(self) -> tuple[float, float, float]:
        given = self.study.calibration
        return given.site_scatter, given.solver_error, given.law_error

    def _fitter(self, problem: Problem) -> Fitter:
        fitter = Fitter(problem, *self._settings)
        if not problem.replicated and self.residual is not None:
            fitter.use_residual_as_noise(self.residual)
        return fitter
