"""The study of a notebook: read from YAML, made of a mapping, or drafted from recordings, and shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from itertools import cycle
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes

from palpate.base.parameters import in_words
from palpate.configuration.study_file import Study, load_study, study_from
from palpate.draft import Drafted, readable, study_name, write_study
from palpate.errors import InputError
from palpate.notebook.measured_test import MeasuredTest
from palpate.notebook.plain_values import plain
from palpate.notebook.session import new_folder
from palpate.notebook.study_tests import OneTest, recording_of, several
from palpate.output.figures.style import SERIES
from palpate.output.shown import Shown, axes_for
from palpate.recordings.readers import VendorTest
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
        """Read a study from its YAML file.

        Parameters
        ----------
        path, data
            See `palpate.configuration.study_file.load_study`; relative paths count from the present folder.

        Raises
        ------
        InputError
            With file, place and remedy, on anything misspelt, missing, contradictory or unphysical.
        """
        if not isinstance(path, str | Path):
            raise _no_study(path)
        return cls.of(load_study(path, None if data is None else str(data)))

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> NotebookStudy:
        """Make a study of a mapping with the keys of a study's YAML file; arrays of NumPy are taken as lists.

        Raises
        ------
        InputError
            As `read`.
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

        given = several(recordings)
        if not given:
            raise InputError("no recordings are given", remedy="give a file or a test", place="recordings")
        radius = None if sphere is None else replace(RADIUS, name="sphere").check(plain(sphere))
        files = [Path(each) for each in given if isinstance(each, str | Path)]
        drafted = readable(files, reported) if files else []
        drafted += [_drafted(each) for each in given if not isinstance(each, str | Path)]
        output = new_folder() if folder is None else Path(folder).resolve()
        name = study_name(output if folder is not None else Path(_origin(given[0])))
        found = write_study(drafted, output, name, reported, law, radius)
        return cls.of(found.study, [*messages, *found.remarks])

    def sentences(self) -> list[str]:
        """Return sentences on it."""
        sets = ", ".join(f"{name} in {folder}" for name, folder in self.recordings.items()) or "none"
        return [
            f"study: {self.file}",
            f"{len(self.cells)} materials to simulate under each condition of the calibration",
            f"recordings: {sets}",
            *self.remarks,
        ]

    def tables(self) -> list[pd.DataFrame]:
        """Return its tables."""
        declared = self.declared
        ranges = pd.DataFrame(
            {"parameter": in_words(name), "unit": declared[name].unit, "from": min(values), "to": max(values)}
            for name, values in {**self.levels, **{name: (value,) for name, value in self.fixed.items()}}.items()
        )
        return [ranges, self.to_frame()]

    def to_frame(self) -> pd.DataFrame:
        """Return one row a condition: name, role, drive with its largest value and unit, duration_s, points."""
        rows = [
            {
                "condition": condition.name,
                "role": condition.role,
                "drive": condition.protocol.control,
                "largest": condition.protocol.largest_drive,
                "unit": condition.protocol.unit,
                "duration_s": float(condition.protocol.knot_time[-1]),
                "points": len(condition.protocol.sample_time),
            }
            for condition in self.conditions
        ]
        return pd.DataFrame(rows)

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
        return f"<Study {self.name!r}: {self.model} under {self.indenter.shape}, conditions {names}>"


def study_of(given: Study | Mapping[str, Any] | str | Path) -> NotebookStudy:
    """Return the study that is meant by a study, a mapping or a YAML file.

    Raises
    ------
    InputError
        When it is none of these, or invalid.
    """
    if isinstance(given, NotebookStudy):
        return given
    if isinstance(given, Study):
        return NotebookStudy.of(given)
    if isinstance(given, Mapping):
        return NotebookStudy.from_mapping(given)
    if isinstance(given, str | Path):
        return NotebookStudy.read(given)
    raise _no_study(given)


def _no_study(given: object) -> InputError:
    remedy = "give a Study, a mapping or a YAML file; Study.draft makes one of recordings"
    return InputError(f"{type(given).__name__} is no study", remedy=remedy, place="study")


def _drafted(given: OneTest) -> Drafted:
    """Return a test or a recording as a draft takes it."""
    if isinstance(given, MeasuredTest):
        return Drafted.of(given.file, given.source, given.corrections)
    recording = recording_of(given)
    return Drafted.of(Path(_origin(given)), VendorTest(recording.name, recording), None)


def _origin(given: OneTest) -> str:
    """Return the name of a drafted study: that of the file without its ending, or of the recording."""
    if isinstance(given, str | Path):
        return Path(given).stem
    return given.file.stem if isinstance(given, MeasuredTest) else recording_of(given).name or "recording"
