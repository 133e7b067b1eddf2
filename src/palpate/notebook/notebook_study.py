"""The study of a notebook: read from YAML, made of a mapping, or drafted from recordings, and shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from itertools import cycle
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes

from indentation_files.readers import VendorTest
from palpate.base.parameters import in_words
from palpate.base.yaml_file import plain
from palpate.configuration.study_file import Study, load_study, study_from
from palpate.draft import Drafted, readable, study_name, write_study
from palpate.errors import InputError
from palpate.notebook.measured_test import MeasuredTest
from palpate.notebook.session import new_folder
from palpate.notebook.study_tests import OneTest, recording_of, several
from palpate.output.figures.style import SERIES
from palpate.output.shown import Shown, axes_for
from palpate.study.indenter import RADIUS
from palpate.study.protocol import LOAD


@dataclass(frozen=True, repr=False)
class NotebookStudy(Shown, Study):
    """A checked study with a summary, a table and a plot; ``from palpate import Study`` names this class.

    It has the attributes of `palpate.configuration.study_file.Study` and is taken wherever that is.

    Parameters
    ----------
    remarks
        What a draft reports: tests that were left out, and anomalies.
    """

    remarks: tuple[str, ...] = ()

    @classmethod
    def of(cls, study: Study, remarks: Iterable[str] = ()) -> NotebookStudy:
        """Return a study as one of a notebook."""
        return cls(**{each.name: getattr(study, each.name) for each in fields(Study)}, remarks=tuple(remarks))

    @classmethod
    def read(cls, path: str | Path, data: str | Path | None = None) -> NotebookStudy:
        """Read a study from its YAML file, as `palpate.configuration.study_file.load_study` does.

        Relative paths count from the present folder. Raises `InputError`, with file, place and remedy, on anything
        misspelt, missing, contradictory or unphysical.
        """
        if not isinstance(path, str | Path):
            remedy = "give a Study, a mapping or a YAML file; Study.draft makes one of recordings"
            raise InputError(f"{type(path).__name__} is no study", remedy=remedy, place="study")
        return cls.of(load_study(path, None if data is None else str(data)))

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> NotebookStudy:
        """Make a study of a mapping with the keys of a study's YAML file, or raise `InputError` as `read`.

        Arrays of NumPy are taken as lists.
        """
        return cls.of(study_from(plain(values), "the mapping"))

    @classmethod
    def draft(
        cls,
        recordings: OneTest | Iterable[OneTest],
        *,
        law: str | None = None,
        sphere: float | None = None,
        folder: str | Path | None = None,
        report: Callable[[str], None] | None = None,
    ) -> NotebookStudy:
        """Make a first study of recordings, as ``palpate draft`` does.

        Tests of one load history are replicates of one condition. Of three or more conditions the middle one
        validates, the others calibrate. Ranges of the parameters are guessed from the curves.

        Parameters
        ----------
        recordings
            A file, a test or a recording, or several of them; of a file all tests are taken.
        law
            Key of the constitutive law, or keys of several joined by ``+``; chosen from the tests when not given.
        sphere
            Radius of a spherical tip [nm]; when not given, the tip is that which the files state, or a Berkovich.
        folder
            Where ``study.yaml`` and ``recordings`` are written, to be inspected, changed and read again; when not
            given, they are removed when Python ends.
        report
            Called with one line for each file or test that is left out, and why.

        Raises
        ------
        InputError
            When no recording can be used, a unit looks mistaken, `sphere` is no radius, or the folder holds a
            study already.
        """
        messages: list[str] = []

        def reported(line: str) -> None:
            messages.append(line)
            if report:
                report(line)

        given = [Path(each) if isinstance(each, str) else each for each in several(recordings)]
        if not given:
            raise InputError("no recordings are given", remedy="give a file or a test", place="recordings")
        radius = None if sphere is None else replace(RADIUS, name="sphere").check(plain(sphere))
        files = [each for each in given if isinstance(each, Path)]
        drafted = readable(files, reported) if files else []
        drafted += [_drafted(each) for each in given if not isinstance(each, Path)]
        output = new_folder() if folder is None else Path(folder).resolve()
        name = study_name(output if folder is not None else _origin(given[0]))
        found = write_study(drafted, output, name, reported, law, radius)
        return cls.of(found.study, [*messages, *found.remarks])

    def sentences(self) -> list[str]:
        """Return file, size, sets of recordings and remarks."""
        sets = ", ".join(f"{name} in {folder}" for name, folder in self.recordings.items()) or "none"
        return [
            f"study: {self.file}",
            f"{len(self.cells)} materials to simulate under each condition of the calibration",
            f"recordings: {sets}",
            *(f"{each.kind} {each.name}, role: {each.role}" for each in self.evidence),
            *self.remarks,
        ]

    def tables(self) -> list[pd.DataFrame]:
        """Return the ranges of the parameters, and the conditions."""
        levels = {**self.levels, **{name: (value,) for name, value in self.fixed.items()}}
        ranges = pd.DataFrame(
            {"parameter": in_words(name), "unit": self.declared[name].unit, "from": min(values), "to": max(values)}
            for name, values in levels.items()
        )
        return [ranges, self.to_frame()]

    def to_frame(self) -> pd.DataFrame:
        """Return one row a condition: name, role, drive with its largest value and unit, duration_s, points."""
        return pd.DataFrame(
            {"condition": condition.name, "role": condition.role, "drive": protocol.control}
            | {"largest": protocol.largest_drive, "unit": protocol.unit}
            | {"duration_s": float(protocol.knot_time[-1]), "points": len(protocol.sample_time)}
            for condition, protocol in ((each, each.protocol) for each in self.conditions)
        )

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the drive over time, dashed for validation, on `ax` or new axes, and return them."""
        ax = axes_for(ax)
        for condition, colour in zip(self.conditions, cycle(SERIES)):
            protocol, style = condition.protocol, "-" if condition.role == "calibrate" else "--"
            ax.plot(protocol.knot_time, protocol.knot_drive, style, color=colour, label=condition.name)
        names = {c.protocol.control: f"{c.protocol.control} [{c.protocol.unit}]" for c in self.conditions}
        ax.set(xlabel="time [s]", ylabel=" or ".join(names[key] for key in sorted(names, key=LOAD.__ne__)))
        ax.set_title(self.title)
        ax.legend()
        return ax

    def __repr__(self) -> str:
        names = ", ".join(condition.name for condition in self.conditions)
        tips = " and ".join(dict.fromkeys(tip.shape for tip in (self.indenter, *self.tips.values())))
        return f"<Study {self.name!r}: {self.model} under {tips}, conditions {names}>"


def study_of(given: Study | Mapping[str, Any] | str | Path) -> Study:
    """Return the study that is meant by a study, a mapping or a YAML file.

    Raises
    ------
    InputError
        Where it is none, or its recordings have not chosen the law yet.
    """
    if isinstance(given, Study):
        found: Study = given
    else:
        found = NotebookStudy.from_mapping(given) if isinstance(given, Mapping) else NotebookStudy.read(given)
    if found.law_is_open:
        remedy = "run it from its folder first (palpate run), or state the law"
        raise InputError("the recordings have not chosen the law yet", remedy=remedy, place="material.model")
    return found


def _drafted(given: OneTest) -> Drafted:
    """Return a test or a recording as a draft takes it."""
    if isinstance(given, MeasuredTest):
        return Drafted.of(given.file, given.source, given.corrections)
    recording = recording_of(given)
    return Drafted.of(_origin(given), VendorTest(recording.name, recording), None)


def _origin(given: OneTest) -> Path:
    """Return after what a drafted study is named: the file without its ending, or the recording."""
    file = given.file if isinstance(given, MeasuredTest) else given
    return Path(file.stem if isinstance(file, Path) else recording_of(file).name or "recording")
