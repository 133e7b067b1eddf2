"""From recordings to parameters: genetic search on surrogates, least squares on the finite elements, intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np
from scipy.linalg import block_diag

from palpate.errors import InputError
from palpate.inference.calibration_result import Calibration
from palpate.inference.coordinates import Coordinates
from palpate.inference.estimates import described, estimates, front, judged, named_matrix, predicted, simulated
from palpate.inference.forward import Forward
from palpate.inference.genetic import Evaluate, Evolution, GeneticSettings, evolve
from palpate.inference.intervals import intervals
from palpate.inference.measures import OBJECTIVES, check_indents, check_measurable
from palpate.inference.observation import Observation
from palpate.inference.on_finite_elements import Linearised, all_errors, estimated, estimated_anew, known_errors
from palpate.inference.recording_noise import complete_noise
from palpate.inference.surrogate_fit import Predictor, WeightedFit
from palpate.inference.surrogate_space import Space
from palpate.inference.trust_region import Descent

LEAST_R2 = 0.9  # chosen: below it a curve is not explained at all, and no parameter is called identified
MOST_MISFIT = 3.0  # chosen, of chi-square per degree of freedom: above it what the model lacks outweighs the noise


@dataclass(frozen=True)
class CalibrationSettings:
    """How to calibrate.

    Parameters
    ----------
    genetic
        Numbers of the genetic search.
    objective
        ``mean_square`` [nm^2] (chapter 5 of the thesis) or ``relative`` [-] (its chapter 4), of each condition.
    aggregated
        Search for the least sum of all objectives instead of the Pareto front with one objective a condition.
    site_scatter
        Assumed standard deviation of the depth factor between sites, where no condition has replicates [-].
    solver_error
        Relative error of grid convergence of the forward model, standard deviation [-], the same factor on all curves;
        `palpate.inference.recording_noise.model_covariance` says where the default comes from.
    """

    genetic: GeneticSettings = field(default_factory=GeneticSettings)
    objective: str = "mean_square"
    aggregated: bool = False
    site_scatter: float = 0.01
    solver_error: float = 0.003

    def __post_init__(self) -> None:
        if self.objective not in OBJECTIVES:
            raise InputError(
                f"objective is {self.objective!r}", remedy=f"use one of: {', '.join(OBJECTIVES)}", place="objective"
            )
        for name in ("site_scatter", "solver_error"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} is negative", remedy="give zero or more", place=name)


def calibrate(
    surrogates: Mapping[str, Predictor],
    observations: Mapping[str, Observation],
    bounds: Mapping[str, tuple[float, float]],
    *,
    rng: np.random.Generator,
    settings: CalibrationSettings | None = None,
    surrogate_error: Mapping[str, np.ndarray] | None = None,
    forward: Forward | None = None,
    report: Callable[[str], None] = print,
) -> Calibration:
    """Calibrate the parameters on all conditions whose role is ``calibrate``.

    The genetic search minimises the thesis' objectives on the mean curves. Its best points are polished by
    generalised least squares with the noise of the recordings. With `forward`, least squares go on from there on the
    forward model itself, beyond the bounds where that fits better; estimate and intervals rest on its curves and
    derivatives. Without, they rest on the surrogates and their errors.

    Parameters
    ----------
    surrogates
        Predictor of each calibrated condition; columns in the order of `bounds`.
    observations
        What was measured. Conditions with the role ``validate`` are only judged, never fitted.
    bounds
        (lower, upper) of each parameter in its unit, within which the surrogates are searched; equal bounds hold it.
    rng
        Source of all randomness.
    surrogate_error
        Errors of the surrogate (k, n_points) of each condition, such as `PODRBF.loo_error_`; their second
        moments join the noise where the estimate rests on the surrogates.
    forward
        The forward model, such as `palpate.inference.forward.FiniteElements`.
    report
        Told how it goes on.

    Raises
    ------
    InputError
        When nothing is to be calibrated, a surrogate is missing, shapes disagree, there are fewer points than
        parameters, a mean depth is constant or nowhere positive, or the relative objective meets a depth that is not
        positive.
    """
    settings = settings or CalibrationSettings()
    space = Space(bounds)
    fitted = {name: item for name, item in observations.items() if item.role == "calibrate"}
    measured = {name: item.mean for name, item in fitted.items()}
    check_consistent(space, surrogates, measured, settings.objective)
    for name, item in observations.items():
        check_indents(name, item)

    evolution = evolve(objectives(space, surrogates, fitted, settings), space.dimensions, settings.genetic, rng)
    starts = starting_points(evolution)
    report(f"genetic search: {int(evolution.history[-1]['evaluations'])} evaluations")
    plain = WeightedFit(space, surrogates, measured, np.eye(sum(map(len, measured.values()))))
    rough = plain.curves(plain.solve(starts))
    noise = complete_noise(fitted, rough, settings.site_scatter)
    covariance = all_errors(fitted, noise, rough, settings.solver_error)
    fit = WeightedFit(space, surrogates, measured, covariance + surrogate_covariance(measured, surrogate_error or {}))
    u = fit.solve(starts)
    own, iterations = space.named(u), []
    curves, solved = predicted(surrogates, observations, space.physical(u)), {}
    around: WeightedFit | Linearised = fit
    coordinates: Space | Coordinates = space
    settled: bool | None = None
    if forward is not None:

        def kept(line: str) -> None:
            iterations.append(line)
            report(line)

        found_there, recorded, observations = on_finite_elements(
            forward, observations, [own, *map(space.named, starts)], rough, settings, rng, kept
        )
        fitted = {name: observations[name] for name in fitted}
        measured = {name: item.mean for name, item in fitted.items()}
        u, settled, coordinates = found_there.u, found_there.settled, forward.coordinates
        noise = complete_noise(fitted, found_there.curves, settings.site_scatter)
        errors = all_errors(fitted, noise, found_there.curves, settings.solver_error)
        around = Linearised(measured, errors, found_there.curves, found_there.slopes, forward.coordinates)
        others = [name for name in observations if name not in fitted]
        solved = {**found_there.curves, **simulated(recorded, others, u, report)}
    found = intervals(around, u, noise, fitted)
    table = judged(observations, curves, solved)
    explained = found.misfit_ratio < MOST_MISFIT and all(table[name]["r2"] > LEAST_R2 for name in fitted)
    seed = getattr(rng.bit_generator.seed_seq, "entropy", None)
    return Calibration(
        parameters=estimates(coordinates, u, found, explained),
        conditions=table,
        surrogate_curves=curves,
        fe_curves=solved,
        confirmed_by="fe" if solved else "surrogate",
        on_surrogates=own,
        iterations=iterations,
        settled=settled,
        misfit_ratio=found.misfit_ratio,
        correlation=named_matrix(coordinates, found.correlation),
        noise={name: described(noise[name], fitted[name]) for name in fitted},
        pareto=front(space, evolution, ["sum"] if settings.aggregated else list(measured)),
        history=[dict(entry) for entry in evolution.history],
        evaluations=int(evolution.history[-1]["evaluations"]),
        settings=asdict(settings),
        seed=seed,
    )


def on_finite_elements(
    forward: Forward,
    observations: Mapping[str, Observation],
    starts: Sequence[Mapping[str, float]],
    rough: Mapping[str, np.ndarray],
    settings: CalibrationSettings,
    rng: np.random.Generator,
    report: Callable[[str], None],
) -> tuple[Descent, Forward, Mapping[str, Observation]]:
    """Return the estimate on the forward model, the model of record, and what was observed.

    Where tests have loads of their own, they are brought to one load at the first of the `starts`, and once more at the
    estimate, from which the search then goes on (`palpate.inference.own_loads`).

    Parameters
    ----------
    forward, observations, settings, rng, report
        As for `calibrate`.
    starts
        Parameters by name, the optimum on the surrogates first.
    rough
        Curve (n_points,) of each condition, about which errors are taken.
    """
    names = [name for name, item in observations.items() if item.role == "calibrate"]

    def brought(values: Mapping[str, float]) -> tuple[Mapping[str, Observation], dict[str, Observation], np.ndarray]:
        own = any(item.own for item in observations.values())
        moved = forward.at_one_load(observations, values, report) if own else observations
        fitted = {name: moved[name] for name in names}
        noise = complete_noise(fitted, rough, settings.site_scatter)
        return moved, fitted, known_errors(fitted, noise, rough, settings.solver_error)

    moved, fitted, known = brought(starts[0])
    found, recorded = estimated(forward.under(names), fitted, known, starts, rng, report)
    if moved is not observations:
        moved, fitted, known = brought(forward.coordinates.named(found.u))
        found = estimated_anew(recorded, fitted, known, found, report)
    return found, recorded, moved


def check_consistent(
    space: Space, surrogates: Mapping[str, Predictor], measured: Mapping[str, np.ndarray], objective: str
) -> None:
    """Raise `InputError` where observations and surrogates do not fit together."""
    if not measured:
        raise InputError("no condition has the role calibrate", remedy="give at least one", place="conditions")
    for name, mean in measured.items():
        check_measurable(name, mean, objective)
        if name not in surrogates:
            raise InputError(f"condition {name} has no surrogate", remedy="fit one", place=name)
        predicted_points = surrogates[name].predict(space.physical(np.full(space.dimensions, 0.5))).shape[1]
        if predicted_points != len(mean):
            raise InputError(
                f"condition {name} was measured at {len(mean)} points, its surrogate has {predicted_points}",
                remedy="resample the recordings on the sample times of the snapshots",
                place=name,
            )
    points = sum(len(mean) for mean in measured.values())
    if points < space.dimensions:
        raise InputError(
            f"{points} points cannot fix {space.dimensions} parameters", remedy="give more points or hold parameters"
        )


def objectives(
    space: Space,
    surrogates: Mapping[str, Predictor],
    observations: Mapping[str, Observation],
    settings: CalibrationSettings,
) -> Evaluate:
    """Objectives (n, m) of a whole generation (n, k): one for each condition, or their sum.

    Loads count as depths, by `palpate.study.quantity.Quantity.nm`, so that the sum is one of like with like.
    """
    measure = OBJECTIVES[settings.objective]
    measured = {name: (item.mean, item.quantity.nm) for name, item in observations.items()}

    def evaluate(u: np.ndarray) -> np.ndarray:
        x = space.physical(u)
        columns = np.column_stack(
            [measure(nm * mean, nm * surrogates[name].predict(x)) for name, (mean, nm) in measured.items()]
        )
        return columns.sum(axis=1, keepdims=True) if settings.aggregated else columns

    return evaluate


def starting_points(evolution: Evolution) -> list[np.ndarray]:
    """Where the polish starts: the best points by the sum of objectives and by each objective."""
    chosen = {int(np.argmin(evolution.objectives.sum(axis=1)))} | {int(i) for i in evolution.objectives.argmin(axis=0)}
    return [evolution.points[i] for i in sorted(chosen)]


def surrogate_covariance(measured: Mapping[str, np.ndarray], errors: Mapping[str, np.ndarray]) -> np.ndarray:
    """Mean outer product of the error curves (k, n_points) of each condition; zero for a condition without."""
    return block_diag(
        *(
            errors[name].T @ errors[name] / len(errors[name]) if name in errors else np.zeros((mean.size, mean.size))
            for name, mean in measured.items()
        )
    )
