"""Checks of a study before anything is simulated; the command line and the workflow begin with them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from indentation_files.recording import Recording
from palpate.choice.choose import check_distinguishable
from palpate.configuration.study_file import Study
from palpate.data.bulk_tests import bulk_tests
from palpate.data.measures import check_measurable
from palpate.data.observation import Observation
from palpate.data.study_recordings import Look, check_given, files_of, resampled, written_by_workflow
from palpate.diagnosis.candidates import candidates
from palpate.diagnosis.constraints import law_of_reference
from palpate.errors import InputError, located_in, part_of
from palpate.models.imprints import imprints
from palpate.solver.variation import applied_to_body
from palpate.study.area_function import GIVE_COEFFICIENTS, AreaFunction
from palpate.study.indenter import check_cone
from palpate.study.protocol import Protocol
from palpate.surrogate import PODRBF

MOST_CHECKED = 3000  # snapshots; beyond, checking takes longer than a minute
UNLOADED = 100.0, 1e4  # nm; contact depths from which unloadings of a reference count


def checked(study: Study, look: Look | None = None) -> Study:
    """Check a study's recordings, the settings of its calibration and what its diagnosis considers, and return it.

    Parameters
    ----------
    look
        See `palpate.data.study_recordings.check_given`.

    Raises
    ------
    InputError
        With file, place and remedy, on the first mistake.
    """
    with located_in(study.file):
        _check_braces(study)
        _check_folders(study)
        _check_laboratory(study)
        check_calibration(study)
        list(bulk_tests(study))
        list(imprints(study))
        if study.diagnosis.enabled and not study.law_is_open:
            check_diagnosis(study)
        if study.instrument:
            given = [name for name in study.recordings if not written_by_workflow(study, name)]
            study.instrument.check_data(file for name in given for file in files_of(study, name))
        for k, recorded in enumerate(check_given(study, look)):
            _check_recorded(study, recorded)
            if study.family and k == 0:
                check_distinguishable(study, recorded)
    return study


def check_calibration(study: Study) -> None:
    """Refuse a surrogate that its snapshots could not be interpolated with.

    Raises
    ------
    InputError
    """
    with part_of("surrogate"):
        cells = np.array([list(cell.values()) for cell in study.cells])
        if len(cells) <= MOST_CHECKED:
            PODRBF(**dict(study.surrogate)).check_points(cells)


def check_diagnosis(study: Study) -> None:
    """Refuse a reference whose tip has no area where tests unload, and mechanisms that a diagnosis cannot consider.

    Raises
    ------
    InputError
    """
    if given := study.diagnosis.reference:
        with part_of("diagnosis.reference"):
            _check_area(AreaFunction(tuple(given.area)))
    candidates(study)


def check_objective(study: Study, observed: Mapping[str, Observation]) -> None:
    """Refuse the objective of a calibration where what was observed under a condition does not allow it.

    Raises
    ------
    InputError
    """
    with part_of("calibration"):
        for condition in study.calibrated:
            check_measurable(condition.name, observed[condition.name].mean, study.calibration.objective)


def _check_recorded(study: Study, recorded: Mapping[str, list[Recording]]) -> None:
    """Refuse an objective, and a reference, with which recordings cannot be compared; raises `InputError`."""
    if study.calibration.objective == "relative":
        check_objective(study, resampled(study, recorded))
    if study.diagnosis.enabled and study.diagnosis.reference:
        pressed = [each.name for each in study.calibrated if each.observable.is_depth and not each.tip]
        with part_of("diagnosis.reference"):
            law_of_reference([test for name in pressed for test in recorded[name]], study)


def _check_folders(study: Study) -> None:
    """Refuse to write recordings into a folder of the user's, or two sets into one; raises `InputError`.

    The workflow empties the folder of a set that it writes: files of the user's in it would be lost.
    """
    for kept in (Path("results"), Path("results") / study.name):
        if os.path.lexists(kept) and not kept.is_dir():
            raise InputError("is no folder, where results are kept", remedy="move it away", file=kept)
    own = {Path("results").resolve() / owner / "recordings" for owner in _owners(study.name)}
    places = {name: Path(os.path.realpath(folder)) for name, folder in study.recordings.items()}
    for name, place in places.items():
        if not written_by_workflow(study, name):
            continue
        if not own.intersection(place.parents):
            raise InputError(
                f"the workflow writes this set, and would empty {study.recordings[name]} first",
                remedy=f"give it results/{study.name}/recordings/{name}, or leave out what writes it",
                place=f"recordings.{name}",
            )
        for other, folder in places.items():
            if other != name and place in (folder, *folder.parents):
                raise InputError(
                    f"it lies in the folder of {name}, which the workflow writes, and empties first",
                    remedy="give each set a folder of its own",
                    place=f"recordings.{other}",
                )


def _check_braces(study: Study) -> None:
    """Refuse paths of rules that Snakemake would take for patterns; raises `InputError`."""
    written = [name for name in study.recordings if written_by_workflow(study, name)]
    paths = {f"recordings.{name}": str(study.recordings[name]) for name in written}
    paths |= {f"evidence[{k}].file": str(each.file) for k, each in enumerate(study.evidence)}
    for place, path in (paths | ({"source.file": str(study.source["file"])} if study.source else {})).items():
        if "{" in path or "}" in path:
            raise InputError(f"{path} has braces, which are wildcards of Snakemake", remedy="rename it", place=place)


def _owners(name: str) -> tuple[str, ...]:
    """Return the folders of results that are a study's own; those of the thesis share one."""
    return (name, "thesis") if name.startswith("thesis_") else (name,)


def _check_laboratory(study: Study) -> None:
    """Refuse mechanisms of a virtual laboratory that cannot act; raises `InputError`."""
    for name, settings in study.laboratory.items():
        for condition in study.conditions:
            specification = study.specification(settings.parameters, condition)
            try:
                applied_to_body(replace(specification, mechanisms=settings.mechanisms))
            except InputError as error:
                where = ".".join(filter(None, (f"laboratory.{name}", error.place or "mechanisms")))
                problem = f"{error.problem} ({condition.name})"
                raise InputError(problem, remedy=error.remedy, place=where) from None


def _check_area(tip: AreaFunction) -> None:
    """Refuse an area function that is none where tests unload; raises `InputError`."""
    if tip.holds_between(*UNLOADED) != UNLOADED:
        raise InputError(
            f"the area is not positive, or does not grow, between {UNLOADED[0]:g} and {UNLOADED[1]:g} nm",
            remedy=GIVE_COEFFICIENTS,
            place="area",
        )
    check_cone(tip, UNLOADED[1])


def check_same_model(study: Study, calibrated: Study) -> None:
    """Refuse the calibration of a study that simulates something else; raises `InputError`."""
    ours, theirs = (", ".join(sorted(each.levels)) for each in (study, calibrated))
    here, there = ({c.name: (c.tip, *_history(c.protocol)) for c in each.conditions} for each in (study, calibrated))
    other = ", ".join(name for name in {**here, **there} if here.get(name) != there.get(name))
    for differs, what in (
        (ours != theirs, f"{theirs}, the study asks for {ours}"),
        (study.model != calibrated.model, f"the law {calibrated.model}"),
        (study.fixed != calibrated.fixed, "other values under material"),
        (study.indenter != calibrated.indenter or study.tips != calibrated.tips, "another indenter"),
        (study.kinematics != calibrated.kinematics, f"{calibrated.kinematics} strains"),
        (here != there, f"other conditions: {other}"),
    ):
        if differs:
            raise InputError(
                f"the calibration is of {what}", remedy="give the calibration of this study, or leave it out",
                place="calibration",
            )  # fmt: skip


def _history(protocol: Protocol) -> tuple[Any, ...]:
    """Return what a protocol prescribes, to be compared."""
    return protocol.control, protocol.compliance, protocol.knot_time.tolist(), protocol.knot_drive.tolist()
