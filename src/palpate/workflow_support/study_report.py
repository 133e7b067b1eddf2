"""The report of a study, from the files of its results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.output.figures.catalogue import FIGURES
from palpate.output.report import study_page
from palpate.output.saved_set import SavedSet
from palpate.output.written_figures import shown, stem_of
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.saved_results import saved_sets


def write(study: Study, folder: Path, made_from: Mapping[str, Any]) -> list[SavedSet]:
    """Write ``report.html`` and ``report.json`` of a study, and return the results that they show.

    Parameters
    ----------
    folder
        Of the study's results, with its figures.
    made_from
        What the study was made from, see `palpate.workflow_support.manifest.of`.
    """
    sets = saved_sets(study, folder)

    def drawn(name: str, saved: SavedSet | None) -> str:
        figure = FIGURES[name]
        of = saved or next(iter(sets), None)
        return shown(figure, of, folder / "figures" / f"{stem_of(figure, of)}.svg") if of else ""

    snapshots = pd.read_csv(folder / "snapshots.csv")
    study_page.write(study, sets, drawn, snapshots, made_from, folder / "report.html")
    write_json(folder / "report.json", study_page.report_json(study, sets, made_from))
    return sets
