"""Checks of a study before anything is simulated; the command line and the workflow begin with them."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.configuration.study_file import Study
from palpate.diagnosis.candidates import candidates
from palpate.errors import InputError, located_in, part_of
from palpate.inference.study_recordings import check_given, written_by_workflow
from palpate.recordings.recording import Recording
from palpate.solver.variation import applied_to_body
from palpate.study.area_function import GIVE_COEFFICIENTS, AreaFunction
from palpate.surrogate import PODRBF
from palpate.workflow_support.steps import settings_of

MOST_CHECKED = 3000  # snapshots; beyond, checking takes longer than a minute
UNLOADED = 100.0, 1e4  # nm; contact depths from which unloadings of a reference count


def checked(study: Study, look: Callable[[str, str, list[Recording]], None] | None = None) -> Study:
    """Check a study's recordings, the settings of its calibration and what its diagnosis considers, and return it.

    Parameters
    ----------
    look
        See `palpate.inference.study_recordings.check_given`.

    Raises
    ------
    InputError
        With file, place and remedy, on the first mistake.
    """
    with located_in(study.file):
        _check_folders(study)
        _check_laboratory(study)
        _check_reference(study)
        with part_of("surrogate"):
            _check_surrogate(study)
        check_given(study, look)
        with part_of("calibration"):
            settings_of(study)
        if study.diagnosis["enabled"]:
            candidates(study)
    return study


def _check_surrogate(study: Study) -> None:
    """Refuse a surrogate that its snapshots could not be interpolated with; raises `InputError`."""
    cells = np.array([list(cell.values()) for cell in study.cells])
    if len(cells) <= MOST_CHECKED:
        PODRBF(**study.surrogate).check_points(cells)


def _check_folders(study: Study) -> None:
    """Refuse to write recordings into a folder of the user's, or two sets into one; raises `InputError`.

    The workflow empties the folder of a set that it writes: files of the user's in it would be lost.
    """
    for kept in (Path("results"), Path("results") / study.name):
        if os.path.lexists(kept) and not kept.is_dir():
            raise InputError("is no folder, where results are kept", remedy="move it away", file=kept)
    results = Path("results").resolve()
    written: dict[Path, str] = {}
    for name, folder in study.recordings.items():
        place = Path(os.path.realpath(folder))
        if written_by_workflow(study, name) and written.setdefault(place, name) != name:
            raise InputError(
                f"the workflow writes this set and {written[place]} into one folder, {folder}",
                remedy=f"give it results/{study.name}/recordings/{name}",
                place=f"recordings.{name}",
            )
        own = results in place.parents and "recordings" in place.relative_to(results).parts[1:-1]
        if written_by_workflow(study, name) and not own:
            raise InputError(
                f"the workflow writes this set, and would empty {folder} first",
                remedy=f"give it results/{study.name}/recordings/{name}, or leave out what writes it",
                place=f"recordings.{name}",
            )


def _check_laboratory(study: Study) -> None:
    """Refuse mechanisms of a virtual laboratory that cannot act; raises `InputError`."""
    for name, settings in study.laboratory.items():
        for condition in study.conditions:
            specification = study.specification(settings["parameters"], condition)
            try:
                applied_to_body(replace(specification, mechanisms=settings.get("mechanisms", {})))
            except InputError as error:
                where = ".".join(filter(None, (f"laboratory.{name}", error.place or "mechanisms")))
                problem = f"{error.problem} ({condition.name})"
                raise InputError(problem, remedy=error.remedy, place=where) from None


def _check_reference(study: Study) -> None:
    """Refuse a reference whose tip has no area where tests unload; raises `InputError`."""
    given = study.diagnosis.get("reference")
    if given and AreaFunction(tuple(given["area"])).holds_between(*UNLOADED) != UNLOADED:
        raise InputError(
            f"the area is not positive, or does not grow, between {UNLOADED[0]:g} and {UNLOADED[1]:g} nm",
            remedy=GIVE_COEFFICIENTS,
            place="diagnosis.reference.area",
        )
