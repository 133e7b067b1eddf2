"""Take results of the epoxy study into these pages: ``python docs/refresh.py [results/epon862]``.

Its answer goes to ``docs/data``, its figures with their captions and a picture of its report to ``docs/images``. The
picture needs ``pip install -e '.[browser]'`` and Chromium.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palpate.output.saved_set import SavedSet

HERE = Path(__file__).parent
IMAGES = HERE / "images"
NAMES = ("curves", "residuals", "misfit_map", "explanations", "parameters", "search", "surrogates")
SCREEN = {"width": 1240, "height": 800}  # pixels, the first screen of the report without margins


def checksum(file: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def figures(saved: SavedSet, folder: Path) -> dict[str, dict[str, str]]:
    """Copy the figures of a study, and return caption, description and checksum of each."""
    from palpate.output.figures.catalogue import FIGURES
    from palpate.output.written_figures import stem_of

    found = {}
    for name in NAMES:
        figure = FIGURES[name]
        file = folder / "figures" / f"{stem_of(figure, saved)}.svg"
        numbers = figure.table(saved)
        assert numbers is not None, name
        target = IMAGES / f"epoxy_{name}.svg"
        shutil.copyfile(file, target)
        texts = {"caption": figure.caption(numbers), "seen": figure.seen(numbers)}
        found[name] = {"title": figure.title, **texts, "sha256": checksum(target)}
    return found


def summaries(saved: SavedSet) -> dict[str, str]:
    """Return what the objects of calibration and diagnosis print."""
    from palpate.output.results.calibration import Calibration
    from palpate.output.results.diagnosis import Diagnosis

    return {"fit": Calibration(saved).summary(), "found": Diagnosis(saved).summary()}


def picture(report: Path, target: Path) -> None:
    """Take a picture of the first screen of a report."""
    from playwright.sync_api import sync_playwright

    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport=SCREEN, color_scheme="light")
        page.goto(report.resolve().as_uri())
        page.wait_for_selector(".plot.curve .main-svg")
        page.screenshot(path=str(target))
        browser.close()


def main(words: Sequence[str]) -> int:
    """Copy answer, figures and a picture of the report."""
    from palpate.configuration.study_file import load_study
    from palpate.workflow_support.saved_results import saved_sets

    folder = Path(words[0] if words else "results/epon862")
    shutil.copyfile(folder / "report.json", HERE / "data/epon862.json")
    saved = saved_sets(load_study(HERE.parent / "config/config.yaml"), folder)[0]
    content = {"answer": checksum(HERE / "data/epon862.json"), "figures": figures(saved, folder)}
    content["summaries"] = summaries(saved)
    (HERE / "data/epon862_figures.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    picture(folder / "report.html", IMAGES / "report.png")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
