"""From recordings to parameters: genetic search on surrogates, least squares on the finite elements, intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from palpate.base.threads import on_one_thread
from palpate.configuration.settings import CalibrationSettings
from palpate.data.measures import check_indents, root_mean_square
from palpate.errors import PalpateError
from palpate.inference.calibration_result import MOST_MISFIT, CalibrationOutcome
from palpate.inference.estimates import (
    bulk_predictions,
    condition_errors,
    estimates,
    intervals,
    law_discrepancy,
    named_matrix,
    noise_table,
)
from palpate.inference.explanation import Fit
from palpate.inference.fitting import Fitter
from palpate.inference.imprint_prediction import imprint_predictions
from palpate.inference.last_steps import on_finer_meshes
from palpate.inference.problem import Problem
from palpate.inference.starting_places import scattered
from palpate.models.own_loads import raise_failure
from palpate.surrogate.genetic_stage import genetic_search
from palpate.surrogate.surrogates import Predictor, Surrogates

LEAST_R2 = 0.9  # chosen: below it a curve is not explained at all, and no parameter is called identified


@on_one_thread
def calibrate(
    problem: Problem,
    surrogates: Mapping[str, Predictor],
    bounds: Mapping[str, tuple[float, float]],
    *,
    rng: np.random.Generator,
    settings: CalibrationSettings | None = None,
    report: Callable[[str], None] = print,
    begin: Sequence[Mapping[str, float]] = (),
) -> CalibrationOutcome:
    """Calibrate the parameters on the conditions of a problem.

    The genetic search minimises the thesis' objectives on the mean curves. From its optimum least squares go on, on the
    forward model itself and beyond the bounds where that fits better; estimate and intervals rest on its curves and
    derivatives. Where they end far from the recordings, or no replicates tell how far, its other points and some places
    scattered over the ranges are tried as well.

    Parameters
    ----------
    settings
        How to calibrate; the defaults when not given.
    problem
        The recordings and the forward model. Conditions that take no part are only judged.
    surrogates
        Predictor of each condition that takes part; columns in the order of `bounds`.
    bounds
        (lower, upper) of each parameter in its unit, within which the surrogates are searched; equal bounds hold it.
    rng
        Source of all randomness.
    report
        Called with one line on the progress.
    begin
        Parameters by name from which least squares may begin, before those that the genetic search finds.

    Raises
    ------
    InputError
        When no condition is to be calibrated, a surrogate is missing, shapes disagree, there are fewer points than
        parameters, a mean depth is constant or nowhere positive, or the relative objective meets a depth that is not
        positive.
    PalpateError
        When the forward model fails wherever a search may begin.
    """
    settings = settings or CalibrationSettings()
    for name, item in problem.recorded.items():
        check_indents(name, item)
    fitted = {name: problem.recorded[name] for name in problem.names}
    model = Surrogates({name: surrogates[name] for name in problem.recorded if name in surrogates}, bounds)
    first = genetic_search(model, fitted, rng, settings)
    report(f"genetic search: {first.evaluations} evaluations")
    problem, fit = base_fit(problem, settings, [*begin, *first.starts], rng, report)
    report(f"least squares: root mean square {root_mean_square(fit.residual):.4g} nm")
    found, solved = intervals(fit), _simulated(problem, fit, report)
    table = condition_errors(problem.recorded, solved)
    weighable = not problem.replicated or fit.misfit_ratio < MOST_MISFIT
    explained = weighable and all(table[name]["r2"] > LEAST_R2 for name in fitted)
    return CalibrationOutcome(
        parameters=estimates(fit, found, explained),
        conditions=table,
        surrogate_curves=first.curves,
        simulated_curves=solved,
        on_surrogates=first.values,
        converged=fit.converged,
        misfit_ratio=fit.misfit_ratio,
        discrepancy=law_discrepancy(fit),
        uniaxial=bulk_predictions(fit, found),
        imprint=imprint_predictions(fit, report),
        correlation=named_matrix(fit.coordinates, found.correlation),
        noise=noise_table(problem, fit.errors.noise),
        pareto=first.front(["sum"] if settings.aggregated else list(fitted)),
        history=[dict(entry) for entry in first.evolution.history],
        evaluations=first.evaluations,
        settings=settings.model_dump(),
        seed=getattr(rng.bit_generator.seed_seq, "entropy", None),
    )


def _from_optimum(fitter: Fitter, start: np.ndarray) -> Fit | None:
    """Return the fit from coordinates (k,), or None where it fails or ends far from the recordings."""
    try:
        fit = fitter.base([start])
    except PalpateError:
        return None
    return fit if fit.misfit_ratio <= fitter.policy.single_start else None


def _simulated(problem: Problem, fit: Fit, report: Callable[[str], None]) -> dict[str, np.ndarray]:
    """Return the forward model's curve of each condition in its own unit; reports where there is none, and why."""
    found = {}
    for name, curve in fit.everywhere.items():
        if isinstance(curve, str):
            report(f"{name} has no errors: {curve.removeprefix(f'{name}: ')}")
        else:
            found[name] = curve / problem.nm[name]
    return found


def base_fit(
    problem: Problem,
    settings: CalibrationSettings,
    starts: Sequence[Mapping[str, float]],
    rng: np.random.Generator,
    report: Callable[[str], None],
) -> tuple[Problem, Fit]:
    """Fit the base model from parameters by name, and from places scattered over the ranges.

    Where tests have loads of their own, they are brought to one load at the first of the `starts`, and once more at the
    estimate, from which the search then goes on (`palpate.models.own_loads`); the problem is returned too. Without
    replicates noise cannot be distinguished from misfit: the fit comes as close to the curves as it can, with no
    factor of the site or of the solver free, and allows for a discrepancy; intervals allow for both, and take what the
    fit leaves beside slow trends for noise, see `palpate.inference.covariance.noise_of`.

    Parameters
    ----------
    problem
        The recordings and the forward model.
    settings
        For the scatter between sites and the error of the solver.
    starts
        Parameters by name.
    rng
        Source of the scattered points.
    report
        Called with one line on the progress.
    """
    brought, coordinates = problem.at_one_load(starts[0], report), problem.forward.coordinates
    fitter = Fitter(brought, settings.site_scatter, settings.solver_error, settings.law_error)
    searched = Fitter.base if problem.replicated else Fitter.closest
    begun = [coordinates.scaled(values) for values in starts]
    fit = _from_optimum(fitter, begun[0]) if problem.replicated else None
    if fit is None:
        fitter = replace(fitter, problem=brought)
        fit = searched(fitter, [*begun, *scattered(problem.material, fitter.policy, rng)])
    if brought is not problem:
        brought = problem.at_one_load(coordinates.named(fit.z), raise_failure)
        fitter = replace(fitter, problem=brought)
        fit = searched(fitter, [fit.z])
    return brought, on_finer_meshes(fitter, fit) if problem.replicated else fitter.reweighed(fit)
