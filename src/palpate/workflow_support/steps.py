"""The steps between files: snapshots to surrogates, surrogates and recordings to calibrations, and those to tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from palpate.configuration.chosen_law import best_parameters
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.data.study_recordings import observations
from palpate.errors import PalpateError
from palpate.inference.calibrate import calibrate
from palpate.inference.calibration_result import CalibrationOutcome
from palpate.inference.problem import Problem
from palpate.models.own_loads import brought_to_one_load
from palpate.observables import OBSERVABLES
from palpate.solver import store
from palpate.surrogate import PODRBF
from palpate.surrogate.saved import load

MOST_FAILED = 0.2  # of all snapshots; chosen: with more, leave-one-out errors do not show the errors in the gaps
END = 0.2  # of a range
MOST_AT_ONE_END = 0.5  # of those in the outer fifth of a parameter's range; chosen: beyond, it is no interpolation


def fit_surrogate(
    study: Study, condition: str, contents: Sequence[Mapping[str, Any]]
) -> tuple[PODRBF, np.ndarray, np.ndarray, dict[str, Any]]:
    """Fit the surrogate of one condition to the contents of its snapshots, see `palpate.solver.store.read`.

    Returns
    -------
    model, parameters, curves, summary
        The estimator, what it was fitted to, and its figures of merit.

    Raises
    ------
    PalpateError
        When too many snapshots failed, see `checked_missing`.
    """
    cells, failed = [found["parameters"] for found in contents], [found["status"] != "ok" for found in contents]
    missing = checked_missing(condition, cells, failed)
    parameters, curves, failures = store.matrix(contents, study.levels)
    unit = OBSERVABLES[contents[0]["quantity"]].unit
    model = PODRBF(**dict(study.surrogate)).fit(parameters, curves)
    summary = {
        "snapshots": len(curves),
        "failed_snapshots": len(failures),
        "missing": missing,
        "modes": int(model.n_modes_),
        "energy_of_first_mode": float(model.energy_[0]),
        "shape": float(model.shape_),
        "condition_number": float(model.condition_number_),
        "unit": unit,
        f"loo_rmse_{unit}": float(np.sqrt(np.mean(model.loo_error_**2))),
        f"loo_largest_point_rms_{unit}": float(model.loo_rms_.max()),
        "loo_relative_percent": relative_percent(model.loo_error_, curves),
        f"loo_rms_{unit}": model.loo_rms_.tolist(),
        "spectrum": np.diff(model.energy_, prepend=0.0).tolist(),
        "failures": failures,
    }
    return model, parameters, curves, summary


def checked_missing(condition: str, cells: Sequence[Mapping[str, float]], failed: Sequence[bool]) -> str:
    """Return how many snapshots failed and where they lie, in a sentence; empty where none did.

    Parameters
    ----------
    cells
        Parameters of all snapshots by name.
    failed
        Which of them failed.

    Raises
    ------
    PalpateError
        When too many failed for a surrogate, altogether or at one end of a parameter's range.
    """
    lost = np.asarray(failed, dtype=bool)
    if not lost.any():
        return ""
    name, end, share = _worst_end(cells, lost)
    where = f", {100 * share:.0f} % of those at the {end} end of {name}" if name else ""
    found = f"{condition}: {lost.sum()} of {len(lost)} snapshots failed{where}"
    if lost.mean() > MOST_FAILED or share > MOST_AT_ONE_END:
        raise PalpateError(
            f"{found}: too many for a surrogate; narrow the ranges of the parameters there (snapshots.csv lists the "
            "reasons)"
        )
    return f"{found}."


def _worst_end(cells: Sequence[Mapping[str, float]], lost: np.ndarray) -> tuple[str, str, float]:
    """Return the parameter, the end of its range (its outer fifth), and what share is lost there, at its largest."""
    worst = ("", "", 0.0)
    for name in cells[0]:
        values = np.array([cell[name] for cell in cells])
        span = values.max() - values.min()
        for end, inside in (("lower", values - values.min()), ("upper", values.max() - values)):
            outer = inside <= END * span
            if span > 0.0 and (share := float(lost[outer].mean())) > worst[2]:
                worst = (name, end, share)
    return worst


def simulated_surrogates(study: Study, curves: Path, report: Callable[[str], None]) -> dict[str, PODRBF]:
    """Return the surrogate of each condition that calibrates; those of its snapshots that are missing are simulated.

    Parameters
    ----------
    study
    curves
        The folder of the store.
    report
        Called with one line on the progress, as the first two steps of three.
    """
    report("step 1 of 3: snapshots")
    contents: dict[str, list[dict[str, Any]]] = {}
    for batch in store.plan(study):
        found = store.computed(batch.snapshots, curves, report)
        for snapshot, content in zip(batch.snapshots, found, strict=True):
            contents.setdefault(snapshot.condition, []).append(content)
    report("step 2 of 3: surrogates")
    models = {}
    for name, snapshots in contents.items():
        models[name], _, _, summary = fit_surrogate(study, name, snapshots)
        if summary["missing"]:
            report(summary["missing"])
    return models


def relative_percent(error: np.ndarray, curves: np.ndarray) -> float:
    """Return the root mean square over the snapshots of error / curve, in the mean along the curve, in per cent.

    As in `palpate.data.measures.error_measures`, values below 1 % of their curve's largest are left out: what is
    left of a recovered body's depth is rounding.

    Parameters
    ----------
    error, curves : ndarray, shape (n_snapshots, n_points)
    """
    deep = curves > 0.01 * curves.max(axis=1, keepdims=True)
    counted = deep.any(axis=0)
    squares = np.divide(error, curves, out=np.zeros_like(curves), where=deep)[:, counted] ** 2
    return float(100 * np.sqrt(squares.sum(axis=0) / deep[:, counted].sum(axis=0)).mean())


def calibrate_study(
    study: Study,
    models: Mapping[str, PODRBF],
    observed: Mapping[str, Observation],
    report: Callable[[str], None] = print,
) -> CalibrationOutcome:
    """Calibrate a study's parameters on what was observed under each condition.

    They are sought on the surrogates, the models of the calibrated conditions, first, and then on the finite elements;
    `report` is called with one line on the progress.
    """
    return calibrate(
        Problem.of(study, observed),
        models,
        {name: (min(levels), max(levels)) for name, levels in study.levels.items()},
        rng=np.random.default_rng(study.seed),
        settings=study.calibration,
        report=report,
        begin=[best_parameters(study.choice)] if study.choice else [],
    )


def run_calibration(
    study: Study,
    recordings: str,
    condition_set: str,
    surrogate_files: Mapping[str, str | Path],
    report: Callable[[str], None] = print,
) -> tuple[CalibrationOutcome, pd.DataFrame]:
    """Calibrate one condition set on one set of recordings, and compute its errors with the solver on every condition.

    The estimate is that of the finite elements at the study's accuracy, so that the surrogates' errors do not bias it.

    Parameters
    ----------
    study, recordings, condition_set
        The study, and the names of the set of recordings and of the conditions.
    surrogate_files
        File of each condition's surrogate.
    report
        Called with one line on the progress.

    Returns
    -------
    calibration, curves
        The outcome, and a table of all curves: condition, role, time_s, load_mN, recorded_nm (mean), spread_nm
        (standard deviation over replicates), surrogate_nm, simulated_nm. Under displacement control displacement_nm
        takes the place of load_mN, and the recorded, the surrogate's and the simulated curves are loads, such as
        recorded_mN.
    """
    members = study.condition_sets[condition_set]
    models: dict[str, PODRBF] = {name: load(surrogate_files[name]) for name in members}
    measured = observations(study, recordings)
    roles = {
        name: item if name in members or item.role == "validate" else replace(item, role="validate")
        for name, item in measured.items()
    }

    result = calibrate_study(study, models, roles, report)
    return result, curves_beside(study, roles, result, report)


def curves_beside(
    study: Study,
    observed: Mapping[str, Observation],
    result: CalibrationOutcome,
    report: Callable[[str], None] = print,
) -> pd.DataFrame:
    """Return a table of the curves of all conditions, recorded, of the surrogates and simulated.

    Tests with loads of their own are brought to one load at the estimate.

    Parameters
    ----------
    study
    observed
        Of every condition by its name.
    result
        The calibration.
    report
        Called with one line for each condition whose tests cannot be brought to one load.

    Returns
    -------
    DataFrame
        Columns as in `run_calibration`.
    """
    tables = []
    observed = brought_to_one_load(study, observed, result.values, report)
    for condition in study.conditions:
        item = observed[condition.name]
        count, unit = len(item.response), item.quantity.unit
        blank = np.full(len(item.time), np.nan)
        tables.append(
            pd.DataFrame(
                {
                    "condition": condition.name,
                    "role": item.role,
                    "time_s": item.time,
                    f"{condition.protocol.control}_{condition.protocol.unit}": condition.protocol.sample_drive,
                    f"recorded_{unit}": item.mean,
                    f"spread_{unit}": item.response.std(axis=0, ddof=1) if count > 1 else blank,
                    f"surrogate_{unit}": result.surrogate_curves.get(condition.name, blank),
                    f"simulated_{unit}": result.simulated_curves.get(condition.name, blank),
                }
            )
        )
    return pd.concat(tables, ignore_index=True)
