"""The page on a study's recordings as they were read: contact, segments and drift of every test, before any model."""

from __future__ import annotations

import html
from pathlib import Path

import numpy as np

from palpate.classical.frame import frame_of
from palpate.configuration.study_file import Study
from palpate.errors import InputError
from palpate.output import html_report
from palpate.output.figures.recorded_test import draw
from palpate.recordings.readers import read_source
from palpate.recordings.readers.vendor import in_words
from palpate.recordings.survey import Survey, survey, table


def write_reading(study: Study, folder: Path) -> None:
    """Write ``survey.csv``, a figure a test and ``reading.html`` for the vendor's file of a study.

    The tests are read with the study's corrections and with their approach, whatever contact the study chooses.

    Raises
    ------
    InputError
        When the study has no vendor's file, or a test is too short to find contact in.
    """
    if not study.source:
        raise InputError("names no vendor's file", remedy="add a section source", file=study.file, place="source")
    folder.mkdir(parents=True, exist_ok=True)
    found: list[Survey] = []
    pieces = []
    for condition, tests in read_source({**study.source, "contact": "none"}).items():
        for test in tests:
            try:
                found.append(survey(test.recording))
            except InputError as error:
                raise error.located(file=study.source["file"], place=test.name) from None
            picture = folder / f"{condition}_{len(found)}.png"
            draw(found[-1], picture, chosen=_chosen(study, found[-1]))
            pieces += [
                f"<h3>{html.escape(condition)}: {html.escape(test.name)}</h3>",
                html_report.image(picture, test.name),
            ]
            pieces += [f"<p>{html.escape(warning)}</p>" for warning in test.warnings]
    rows = table(found)
    rows.to_csv(folder / "survey.csv", index=False)
    applied, contact = in_words(study.source.get("corrections")), study.source.get("contact", "file")
    facts = f"<p>Corrections in the depth: {applied}. Contact that the study uses: {contact}."
    frame = frame_of([(s.recording.load - s.contact.load, s.recording.depth, s.parts) for s in found])
    if frame is not None:
        facts += (
            f" The tops of {frame.unloadings} unloadings say that a frame compliance of {frame.compliance:.3g} nm/mN "
            f"({frame.lower:.3g} to {frame.upper:.3g}) is in the depth, if the tests are on one material."
        )
    sections = [("What was found", [f"{facts}</p>", html_report.table(rows)]), ("The tests", pieces)]
    html_report.build(f"{study.title}: the recordings as read", sections, [], folder / "reading.html")


def _chosen(study: Study, found: Survey) -> float | None:
    """Return the depth of the contact that the study uses [nm], or None where that is the one found."""
    contact = study.source.get("contact", "file")
    if contact == "file":
        return float(np.interp(0.0, found.recording.time, found.recording.depth))
    return None if contact == "auto" else float(contact)
