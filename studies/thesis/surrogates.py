"""Surrogates over the epoxy's grids, which several studies use: one for each of the four loading times."""

from __future__ import annotations

from palpate.surrogate import PODRBF
from studies.thesis.fitted import Fitted
from studies.thesis.grids import CALIBRATED, EPOXY_GRIDS
from studies.thesis.study import Context


def epoxy_surrogate(context: Context, condition: str) -> PODRBF:
    """Return the surrogate of one loading time over the grid of 288 points."""
    study, grid = context.studies["epoxy"], context.curves[EPOXY_GRIDS[condition]].succeeded()
    return PODRBF(**dict(study.surrogate)).fit(grid.matrix(study.levels), grid.depth)


def epoxy_surrogates(context: Context) -> dict[str, PODRBF]:
    """Return all four."""
    return {name: epoxy_surrogate(context, name) for name in CALIBRATED}


def epoxy_fitted(context: Context, models: dict[str, PODRBF]) -> list[Fitted]:
    """Return all four for MLflow."""
    levels = context.studies["epoxy"].levels
    grids = {name: context.curves[EPOXY_GRIDS[name]].succeeded() for name in models}
    return [
        Fitted.surrogate(f"epoxy {name}", model, grids[name].matrix(levels), grids[name].depth)
        for name, model in models.items()
    ]
