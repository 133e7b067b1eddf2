"""The recordings of a study: found, checked against the study before anything is simulated, and resampled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from palpate.configuration.schema import suggestion
from palpate.configuration.study_file import Condition, Study
from palpate.errors import InputError
from palpate.inference.observation import WHOLE, Observation
from palpate.recordings.alignment import aligned
from palpate.recordings.readers import read_source
from palpate.recordings.readers.units import CHANNELS, to_turn
from palpate.recordings.recording import Recording, copies
from palpate.recordings.recording_file import condition_of, read_recording, recording_files
from palpate.study.indenter import Indenter
from palpate.study.protocol import LOAD, Protocol
from palpate.study.quantity import Quantity

LOAD_TOLERANCE = 0.05
LEAST_POSITIVE = 0.05
SHALLOWEST = 0.2
DEEPEST = 30.0
DEEPEST_IN_SPHERE = 3.0  # radii; a zero point that is off by a radius is not a mistaken unit


def find(study: Study, name: str) -> dict[str, list[Path]]:
    """Return the files of each condition in set `name`.

    Raises
    ------
    InputError
        When the folder or a condition's recordings are missing, or a file belongs to no condition.
    """
    folder = study.recordings[name]
    if not folder.is_dir():
        problem = "is a file, no folder" if folder.exists() else "the folder is missing"
        raise InputError(problem, remedy=f"correct recordings.{name} in {study.file}", file=folder)
    names = [condition.name for condition in study.conditions]
    found: dict[str, list[Path]] = {name: [] for name in names}
    for file in recording_files(folder):
        condition = condition_of(file)
        if condition not in found:
            raise InputError(
                "the file's name is not CONDITION_REPLICATE.csv with a condition of the study",
                remedy=f"move it away, or add its condition to {', '.join(names)}",
                file=file,
            )
        found[condition].append(file)
    for condition, files in found.items():
        if not files:
            raise InputError(
                f"no recording of condition {condition!r}",
                remedy=f"add {condition}_1.csv or remove the condition",
                file=folder,
            )
    return found


def check(study: Study, name: str) -> dict[str, list[Recording]]:
    """Read every recording of set `name` and check it against the study; raises `InputError`."""
    checked: dict[str, list[Recording]] = {}
    for condition, files in find(study, name).items():
        checked[condition] = []
        for file in files:
            try:
                checked[condition].append(_checked(study, study.condition(condition), read_recording(file)))
            except InputError as error:
                raise error.located(file=file) from None
    return checked


def check_tests(study: Study, tests: Mapping[str, Sequence[Recording]]) -> dict[str, list[Recording]]:
    """Check recordings in memory, by the names of their conditions, and return them from contact on.

    Raises
    ------
    InputError
        When a condition is none of the study's or has no recording, a recording is given twice, or is not one of its
        condition.
    """
    names = [condition.name for condition in study.conditions]
    for name in tests:
        if name not in names:
            problem = f"{name!r} is no condition of the study{suggestion(name, names)}"
            raise InputError(problem, remedy=f"use {', '.join(names)}", place="recordings")
    checked: dict[str, list[Recording]] = {}
    for name in names:
        if not tests.get(name):
            remedy = "add one, or remove the condition"
            raise InputError(f"no recording of condition {name!r}", remedy=remedy, place="recordings")
        for copy, _ in copies(tests[name]):
            remedy = "remove one of them: each replicate is a test of its own"
            raise InputError(f"{copy.name} is given twice", remedy=remedy, place=f"recordings.{name}")
        try:
            checked[name] = [_checked(study, study.condition(name), recording) for recording in tests[name]]
        except InputError as error:
            raise error.located(place=f"recordings.{name}") from None
    return checked


def check_given(study: Study) -> None:
    """Check every set of recordings that exists before the workflow runs, and the tests of the vendor's file.

    Replicates that are copies of one another are refused: they would suggest that sites never differ and noise does not
    exist.
    """
    remedy = "remove one of them: each replicate is a test of its own"
    for name in study.recordings:
        if not written_by_workflow(study, name):
            for recordings in check(study, name).values():
                for copy, first in copies(recordings):
                    file = study.recordings[name] / f"{copy.name}.csv"
                    raise InputError(f"is the same recording as {first.name}.csv", remedy=remedy, file=file)
    for condition, tests in (read_source(study.source) if study.source else {}).items():
        for test in tests:
            try:
                _checked(study, study.condition(condition), test.recording)
            except InputError as error:
                where = ", ".join(filter(None, (test.name, error.place)))
                raise InputError(error.problem, remedy=error.remedy, file=study.source["file"], place=where) from None
        for copy, first in copies(replace(test.recording, name=test.name) for test in tests):
            problem = f"is the same test as {first.name}"
            raise InputError(problem, remedy=remedy, file=study.source["file"], place=copy.name)


def written_by_workflow(study: Study, name: str) -> bool:
    """Return whether set `name` comes from a virtual laboratory or is converted from a vendor's file."""
    return name in study.laboratory or name == study.source.get("recordings")


def files_of(study: Study, name: str) -> list[Path]:
    """Return the files of set `name`: those that are there, or those that the workflow itself will write."""
    folder = study.recordings[name]
    if name in study.laboratory:
        counts = {condition.name: study.laboratory[name]["replicates"] for condition in study.conditions}
    elif name == study.source.get("recordings"):
        counts = {condition: len(tests) for condition, tests in read_source(study.source).items()}
    else:
        return [file for files in find(study, name).values() for file in files]
    return [folder / f"{condition}_{number + 1}.csv" for condition, count in counts.items() for number in range(count)]


def _checked(study: Study, condition: Condition, recording: Recording) -> Recording:
    """Return the recording from contact on, on the clock of its condition where that follows a recorded load, checked.

    Raises
    ------
    InputError
        When points are too few, load or depth is negative, or the recording is not one of the condition.
    """
    count = len(study.free_parameters)
    if len(recording) <= count:
        raise InputError(f"has {len(recording)} points for {count} free parameters", remedy="export the whole curve")
    for channel, values in (("load", recording.load), ("depth", recording.depth)):
        if values.max() < LEAST_POSITIVE * -values.min():
            unit = CHANNELS[channel]
            raise InputError(
                f"the {channel} is negative, down to {values.min():.4g} {unit}: its sign is wrong",
                remedy=to_turn(channel),
                place=f"{channel}_{unit}",
            )
    begun = recording.from_contact(condition.protocol.drive_of(recording.load, recording.depth))
    if condition.follows:
        begun = aligned(begun, condition.protocol)
    _check_one(study, condition, begun)
    return begun


def _check_one(study: Study, condition: Condition, recording: Recording) -> None:
    """Check drive, duration and depth.

    No body is shallower than an elastic one of its modulus, and soft metals in long creep lie within about ten times
    that depth; a unit mistaken by 1000 moves the depth at a given load by 1000, and that load's elastic depth by 30 or
    more. Depths outside 1/5 to 30 elastic depths of the grid's moduli are therefore taken for a mistaken unit.
    """
    check_drive(condition.protocol, recording)
    radius, depth = study.indenter.radius, recording.depth.max()
    if study.indenter.shape == "sphere" and depth > DEEPEST_IN_SPHERE * radius:
        raise InputError(
            f"the largest depth is {depth:.4g} nm, under a sphere of {radius:g} nm; is the radius in um?",
            remedy="write indenter.radius in nm",
            place="depth_nm",
        )
    elastic = [
        depth for modulus in _moduli(study) for depth in elastic_depths(study.indenter, recording.load.max(), modulus)
    ]
    for wrong, words in (
        (depth < SHALLOWEST * min(elastic), "are depths in micrometres, or loads in uN?"),
        (depth > DEEPEST * max(elastic), "are depths in pm, or loads in N?"),
    ):
        if wrong:
            raise InputError(
                f"the largest depth is {depth:.4g} nm, where elastic bodies of the study's moduli give "
                f"{min(elastic):.4g} to {max(elastic):.4g} nm; {words}",
                remedy="write depths in nm and loads in mN, or correct the moduli",
                place="depth_nm",
            )


def check_drive(protocol: Protocol, recording: Recording) -> None:
    """Check that the drive of a recording agrees with its protocol, to a twentieth of the largest value.

    Raises
    ------
    InputError
        When the largest load or displacement, the duration, or the history differs.
    """
    control, unit = protocol.control, protocol.unit
    drive = protocol.drive_of(recording.load, recording.depth)
    peak, expected = drive.max(), protocol.largest_drive
    place = "load_mN" if control == LOAD else "depth_nm"
    if abs(peak / expected - 1) > LOAD_TOLERANCE:
        wrong = ("loads in uN", "loads in N") if control == LOAD else ("depths in pm", "depths in um")
        hint = f"; are {wrong[0]}?" if peak > 100 * expected else f"; are {wrong[1]}?" if peak < expected / 100 else ""
        raise InputError(
            f"the largest {control} is {peak:.4g} {unit}, the condition's is {expected:.4g} {unit}{hint}",
            remedy=f"correct the unit{'' if control == LOAD else ', the spring'} or max_{control}",
            place=place,
        )
    duration, times = recording.time[-1], protocol.sample_time
    if duration < WHOLE * times[-1]:
        raise InputError(
            f"ends after {duration:.4g} s, the condition lasts {times[-1]:.4g} s",
            remedy="export the whole test or correct the times",
            place="time_s",
        )
    departure = np.interp(times, np.append(0.0, recording.time), np.append(0.0, drive))
    departure -= protocol.sample_drive
    if np.sqrt(np.mean(departure**2)) > LOAD_TOLERANCE * expected:
        worst = int(np.argmax(np.abs(departure)))
        hint = f"; it lasts {duration:.4g} s, are times in ms?" if duration > 100 * times[-1] else ""
        raise InputError(
            f"the {control} departs from the condition's, by {departure[worst]:.3g} {unit} at {times[worst]:.4g} "
            f"s{hint}",
            remedy="correct the times of the condition, or give it `load_history: recorded`",
            place=place,
        )


def _moduli(study: Study) -> Iterable[float]:
    return study.levels.get("youngs_modulus") or (study.fixed["youngs_modulus"],)


def elastic_depths(indenter: Indenter, load: float, modulus: float) -> list[float]:
    """Return the depth [nm] of an elastic, incompressible body under the cone (Sneddon) and the sphere (Hertz).

    A rounded cone has both, and its true depth lies between them.

    Parameters
    ----------
    load, modulus
        [mN], [GPa]; the effective modulus is 4/3 of Young's.
    """
    reduced, depths = 4 / 3 * modulus, []
    if np.isfinite(indenter.slope):
        depths.append(1e3 * float(np.sqrt(0.5 * np.pi * load / reduced * indenter.slope)))
    if indenter.radius:
        depths.append(1e3 * float((9 / 16 * (load / reduced) ** 2 / (indenter.radius * 1e-3)) ** (1 / 3)))
    return depths


def observations(study: Study, name: str) -> dict[str, Observation]:
    """Return all conditions of set `name`, resampled to the sampling times of their protocols."""
    return resampled(study, check(study, name))


def resampled(study: Study, checked: Mapping[str, list[Recording]]) -> dict[str, Observation]:
    """Return checked recordings, resampled to the sampling times of their protocols."""
    found = {}
    for key, recordings in checked.items():
        condition = study.condition(key)
        protocol = condition.protocol
        item = Observation.from_recordings(protocol.sample_time, recordings, condition.role, protocol.response)
        found[key] = replace(item, quantity=Quantity.of(protocol, study.indenter, item.mean))
    return found


def convert_source(study: Study, folder: Path) -> None:
    """Write the tests of the study's vendor file as replicates of their conditions; stiffness in a folder beside."""
    source = study.source
    notes = tuple(f"{key}: {source[key]}" for key in ("repository", "commit", "path", "licence") if key in source)
    folder.mkdir(parents=True, exist_ok=True)
    for old in recording_files(folder):
        old.unlink()
    for condition, tests in read_source(source).items():
        for number, test in enumerate(tests, 1):
            notes_of_test = (*test.recording.notes, *test.warnings, *notes)
            replace(test.recording, notes=notes_of_test).write_apart(folder / f"{condition}_{number}.csv")
