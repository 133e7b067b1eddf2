"""The page on a study's recordings as they were read: contact, segments and drift of every test, before any model."""

from __future__ import annotations

import html
from collections import Counter
from pathlib import Path

from indentation_files.readers import read_source
from indentation_files.readers.vendor import in_words
from indentation_files.readers.zero import decision
from indentation_files.survey import Survey, survey_each, table
from palpate.classical.frame import frame_of
from palpate.configuration.study_file import Study
from palpate.errors import InputError, located_in
from palpate.output import html_report
from palpate.output.figures.recorded_test import draw


def write_reading(study: Study, folder: Path) -> None:
    """Write ``survey.csv``, a figure a test and ``reading.html`` for the vendor's file of a study.

    The tests are read with the study's corrections and with their approach, whatever contact the study chooses.

    Raises
    ------
    InputError
        When the study has no vendor's file, or no test of it is long enough to find contact in.
    """
    if not study.source:
        raise InputError("names no vendor's file", remedy="add a section source", file=study.file, place="source")
    folder.mkdir(parents=True, exist_ok=True)
    found: list[Survey] = []
    pieces: list[str] = []
    taken: list[tuple[str, float]] = []
    begun = study.source_tests()
    whole = read_source({**study.source, "contact": "none"})
    recordings = [test.recording for tests in whole.values() for test in tests]
    with located_in(study.source["file"]):
        surveys = iter(survey_each(recordings))
    for condition, tests in whole.items():
        for number, (test, used) in enumerate(zip(tests, begun[condition], strict=True), 1):
            seen = next(surveys)
            pieces.append(f"<h3>{html.escape(condition)}: {html.escape(test.name)}</h3>")
            if isinstance(seen, InputError):
                pieces.append(html_report.paragraph(f"Not surveyed: {seen.problem}."))
                continue
            found.append(seen)
            taken.append(decision(test.recording, used.recording))
            picture = folder / f"{condition}_{number}.png"
            draw(seen, picture, taken[-1])
            pieces += [
                html_report.image(picture, test.name),
                html_report.paragraph(f"Contact taken: {taken[-1][0]}, {taken[-1][1]:.4g} nm."),
                *map(html_report.paragraph, used.warnings),
            ]
    rows = table(found, taken)
    rows.to_csv(folder / "survey.csv", index=False)
    deciders = ", ".join(f"{count} {decider}" for decider, count in Counter(decider for decider, _ in taken).items())
    facts = f"Corrections in the depth: {in_words(study.source.get('corrections'))}. Contacts taken: {deciders}."
    frame = frame_of([(s.recording.load - s.contact.load, s.recording.depth, s.parts) for s in found])
    if frame is not None:
        facts += (
            f" The initial slopes of {frame.unloadings} unloadings show a frame compliance of {frame.compliance:.3g} "
            f"nm/mN ({frame.lower:.3g} to {frame.upper:.3g}) in the depth, if all tests are on one material."
        )
    sections = [("What was found", [html_report.paragraph(facts), html_report.table(rows)]), ("The tests", pieces)]
    html_report.build(f"{study.title}: the recordings as read", sections, [], folder / "reading.html")
