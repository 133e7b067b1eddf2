"""Laws of one family under the same recordings: where their fits begin, the fits, and their evidence.

All laws are judged with one noise, one error of the solver and one prior of the discrepancy
(`palpate.inference.discrepancy`), so that their log evidences can be subtracted. Their parameters have priors that are
even over the ranges which the recordings suggest without a simulation (`palpate.draft.guesses`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.problem import Problem
from palpate.materials import law_of
from palpate.materials.first_guess import Guessed

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

    def at_base(self, law: str, values: Mapping[str, float]) -> list[np.ndarray]:
        """Return the coordinates (k,) at which a law equals the base law, or nearly so; none if it does not contain it.

        Parameters
        ----------
        law
            Its key.
        values
            Of all parameters that have a neutral value, by name (`palpate.materials.families.neutral`).
        """
        coordinates = self.problem(law).forward.coordinates
        if not set(coordinates.names) <= set(values):
            return []
        return [np.clip(coordinates.scaled(values), *coordinates.limits)]

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

    @cached_property
    def _settings(self) -> tuple[float, float, float]:
        given = self.study.calibration
        return given.site_scatter, given.solver_error, given.law_error

    def _fitter(self, problem: Problem) -> Fitter:
        fitter = Fitter(problem, *self._settings)
        if not problem.replicated and self.residual is not None:
            fitter.use_residual_as_noise(self.residual)
        return fitter
