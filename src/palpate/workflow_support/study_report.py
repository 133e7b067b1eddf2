"""The report of a study, from the files of its results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.output import html_report
from palpate.recordings.recording_file import holds_synthetic
from palpate.workflow_support.result_files import read_json


def write(study: Study, folder: Path, path: Path, made_from: Mapping[str, Any]) -> None:
    """Write the report of a study to `path`.

    It shows what the `folder` of results holds, and what the study was `made_from`
    (`palpate.workflow_support.manifest.of`).
    """
    index = pd.read_csv(folder / "snapshots.csv")
    failed = int((index["status"] != "ok").sum())
    summary = html_report.paragraph(f"{len(index)} snapshots, {failed} failed.")
    sections: list[tuple[str, list[str]]] = [
        ("Snapshots and surrogates", [summary, html_report.image(folder / "figures/surrogates.png", "surrogates")])
    ]
    summaries = [read_json(folder / "surrogates" / f"{c.name}.json") for c in study.calibrated]
    notes = [summary["missing"] for summary in summaries if summary["missing"]]
    notes += synthetic_sets(study)
    for recordings in study.recordings:
        found = folder / recordings
        diagnosis = _diagnosis(found) if study.diagnosis["enabled"] else []
        sections.append((f"Recordings: {recordings}", [*diagnosis, *_calibration(study, found)]))
    if study.source:
        facts = "; ".join(f"{key} {value}" for key, value in study.source.items() if key not in ("file", "recordings"))
        sections.append(("Source of the recordings", [html_report.paragraph(facts)]))
    sections.append(("Inputs and versions", _origin(made_from)))
    html_report.build(study.title, sections, notes, path)


def synthetic_sets(study: Study) -> list[str]:
    """Return which sets of recordings hold simulated ones, one line each."""
    written = "are synthetic: written by a virtual laboratory, not measured."
    given = "contain synthetic ones: simulated, not measured."
    return [
        f"Recordings “{name}” {written if name in study.laboratory else given}"
        for name, folder in study.recordings.items()
        if holds_synthetic(folder)
    ]


def _calibration(study: Study, found: Path) -> list[str]:
    """Return what the report shows of the calibrations of the recordings whose results lie in the folder `found`."""
    calibration, parameters = read_json(found / "calibration.json"), pd.read_csv(found / "parameters.csv")
    parameters.insert(1, "unit", [study.declared[name].unit for name in parameters["parameter"]])
    return [
        html_report.paragraph(html_report.misfit_sentence(calibration)),
        html_report.paragraph(html_report.search_sentences(calibration)),
        html_report.paragraph(html_report.bound_sentence(calibration)),
        html_report.table(pd.read_csv(found / "errors.csv")),
        html_report.table(parameters.rename(columns={"held": "held constant"})),
        html_report.image(found / "figures/parameters.png", "calibrated parameters"),
        *(html_report.image(found / f"figures/fit_{name}.png", f"fit of {name}") for name in study.condition_sets),
        html_report.image(found / "figures/convergence.png", "convergence of the genetic algorithm"),
    ]


def _diagnosis(found: Path) -> list[str]:
    """Return what the report shows of the diagnosis of the recordings whose results lie in the folder `found`."""
    diagnosis = read_json(found / "diagnosis.json")
    pieces = [
        html_report.paragraph(diagnosis["sentence"]),
        html_report.image(found / "figures/diagnosis.png", "diagnosis"),
        f'<p>More in <a href="{found.name}/diagnosis.html">the diagnosis</a>.</p>',
    ]
    if diagnosis["candidates"]:
        without = "Below is the base model's fit, without the mechanisms that the diagnosis found."
        pieces.append(html_report.paragraph(without))
    return pieces


def _origin(made_from: Mapping[str, Any]) -> list[str]:
    """Return the versions of the programs, and the checksums of the files behind the report."""
    libraries = ", ".join(f"{name} {number}" for name, number in made_from["libraries"].items())
    versions = f"Python {made_from['python']}, {libraries}; commit {made_from['git_commit']}; seed {made_from['seed']}."
    table = pd.DataFrame({"file": made_from["files"].keys(), "SHA-256": made_from["files"].values()})
    return [html_report.paragraph(versions), html_report.table(table)]
