"""Designs that several studies share: the orthogonal arrays and the surrogate grids of chapters 4 and 5."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from palpate.configuration.study_file import Study
from palpate.design.sampling import factorial, midpoints
from studies.thesis.orthogonal_arrays import OrthogonalArray
from studies.thesis.runs import Design, Run, study_runs

Studies = Mapping[str, Study]
Outcomes = Mapping[str, Mapping[str, Any]]
EPOXY_SCREENING = {
    "youngs_modulus": (3.0, 3.25, 3.5),
    "steady_coefficient": (0.02, 0.06, 0.1),
    "steady_exponent": (0.15, 0.25, 0.35),
    "transient_coefficient": (0.15, 0.25, 0.35),
    "transient_exponent": (0.2, 0.5, 0.8),
    "retardation_time": (0.1, 0.25, 0.4),
}
CALIBRATED = ("P1.00_T030", "P1.00_T045", "P1.00_T060", "P1.00_T240")
ALUMINIUM = ("P4.90_T015",)
ALUMINIUM_GRIDS = {"64": "aluminium_full", "36": "aluminium_reduced"}  # designs by their number of points
EPOXY_GRIDS = {name: f"epoxy_{name}" for name in CALIBRATED}  # by condition


def ranges(levels: Mapping[str, Sequence[float]]) -> dict[str, tuple[float, float]]:
    """Return the least and the largest level of each parameter."""
    return {name: (min(values), max(values)) for name, values in levels.items()}


def l16(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return chapter 4's modified L16."""
    study = studies["aluminium"]
    return study_runs(study, OrthogonalArray.of("L16", tuple(study.levels)).points(study.levels), ALUMINIUM)


def l27(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return chapter 5's L27 under each of the four conditions."""
    points = OrthogonalArray.of("L27", tuple(EPOXY_SCREENING)).points(EPOXY_SCREENING)
    return study_runs(studies["epoxy"], points, CALIBRATED)


def full_grid(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return the 64 points of chapter 4 before the levels are reduced, and the mid-points of their cells."""
    return _with_midpoints(studies["aluminium"], studies["aluminium"].levels)


def reduced_grid(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return the points of chapter 4 that the analysis of variance leaves, and the mid-points of their cells."""
    return _with_midpoints(studies["aluminium"], outcomes["anova_aluminium"]["series"]["reduced_levels"])


def _with_midpoints(study: Study, levels: Mapping[str, Any]) -> list[Run]:
    runs = []
    for role, points in (("training", factorial(levels)), ("midpoint", midpoints(levels))):
        runs += [replace(run, labels={**run.labels, "role": role}) for run in study_runs(study, points, ALUMINIUM)]
    return runs


def epoxy_grid(condition: str, studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return chapter 5's 288 points under one condition."""
    return study_runs(studies["epoxy"], studies["epoxy"].cells, (condition,))


DESIGNS = {
    "aluminium_L16": Design(l16, material="aluminium", libraries=("pydoe",)),
    "aluminium_full": Design(full_grid, material="aluminium"),
    "aluminium_reduced": Design(reduced_grid, after=("anova_aluminium",), material="aluminium"),
    "epoxy_L27": Design(l27, libraries=("pydoe",)),
    **{design: Design(partial(epoxy_grid, name)) for name, design in EPOXY_GRIDS.items()},
}
