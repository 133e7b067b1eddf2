"""Make the pictures of ``docs/tracking.md``: ``python docs/tracking_pictures.py FOLDER``, an empty folder.

A small study, ``docs/data/comparison.yaml``, is run with two kernels and two laws on the same two sets of recordings;
then Chromium opens what ``palpate ui`` links to. This needs ``pip install -e '.[browser]'`` and Chromium.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import yaml

HERE = Path(__file__).parent
STUDY = HERE / "data/comparison.yaml"
ELASTIC = {
    "material": {"model": "elastic", "poisson_ratio": 0.34},
    "parameters": {"youngs_modulus": [1.5, 2.0, 2.5, 3.0]},
}
VARIATIONS: list[dict[str, Any]] = [{}, {"surrogate": {"kernel": "gaussian"}}, ELASTIC]
BURGERS, MULTIQUADRIC = "law = 'nonlinear Burgers'", "kernel = 'multiquadric'"
COMPARED = {  # parameters and metrics that are compared, and of which runs
    "kernels": (("kernel", "recordings"), ("youngs_modulus", "chi2_per_dof", "before_held_out_nm"), BURGERS),
    "laws": (("law", "recordings"), ("youngs_modulus", "before_held_out_nm"), MULTIQUADRIC),
}
ONE_DIAGNOSIS = "tags.kind = 'explanation' and tags.recordings = 'drifting' and params.kernel = 'gaussian'"
PORT = 5177
PATIENCE = 240_000  # ms, for a page
DRAWN = 4000  # ms, for what is drawn after it was loaded
WIDTH = 1700  # pixels


def run_all() -> None:
    """Write the recordings, and run each variation of the study on them in the present folder."""
    from palpate.configuration.study_file import study_from
    from palpate.laboratory import virtual

    content = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    study = study_from(content, STUDY.name)
    for name, folder in study.recordings.items():
        virtual.write(study, name, folder)
    del content["laboratory"]
    for variation in VARIATIONS:
        Path("comparison.yaml").write_text(yaml.safe_dump(content | variation), encoding="utf-8")
        subprocess.run([sys.executable, "-m", "palpate.cli.main", "run", "comparison.yaml", "--cores", "1"], check=True)


def pictures(server: str) -> None:
    """Take the pictures."""
    from playwright.sync_api import sync_playwright

    from palpate.workflow_support import saved_view
    from palpate.workflow_support.tracking import connected, experiments

    experiment = experiments(Path("results"))["comparison"]
    client, of = connected(Path("results")), quote(json.dumps([experiment]))
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])

        def opened(address: str, text: str, height: int) -> Any:
            page = browser.new_page(viewport={"width": WIDTH, "height": height})
            page.set_default_timeout(PATIENCE)
            page.goto(address)
            page.get_by_text(text).first.wait_for()
            page.get_by_role(
                "button", name="Close", exact=True
            ).click()  # the assistant, which takes a third of the page
            page.get_by_role("button", name="Toggle sidebar").click()
            page.wait_for_timeout(DRAWN)
            return page

        def compared(parameters: Sequence[str], metrics: Sequence[str], which: str) -> Any:
            found = client.search_runs([experiment], f"tags.kind = 'recordings' and params.{which}")
            chosen = quote(json.dumps([run.info.run_id for run in found]))
            address = f"{server}/#/compare-runs?runs={chosen}&experiments={of}"
            page = opened(address, "Parallel Coordinates Plot", 640)
            page.get_by_role("button", name="Clear All").click()
            for box, names in zip(page.get_by_role("combobox").all(), (parameters, metrics), strict=True):
                for name in names:
                    box.click()
                    box.fill(name)
                    page.wait_for_timeout(DRAWN // 4)
                    page.keyboard.press("Enter")
                page.keyboard.press("Escape")
            return page

        def save(page: Any, name: str) -> None:
            page.wait_for_timeout(DRAWN)
            page.screenshot(path=str(HERE / f"images/{name}.png"))
            page.close()

        save(opened(saved_view.link(server, experiment), "held_out_nm", 620), "tracking_sets")
        page = opened(saved_view.link(server, experiment, saved_view.EXPLANATIONS_ID), "log_evidence", 560)
        page.locator("input[value^='tags.kind']").fill(ONE_DIAGNOSIS)
        page.keyboard.press("Enter")
        save(page, "tracking_explanations")
        for name, choice in COMPARED.items():
            save(compared(*choice), f"tracking_{name}")
        browser.close()


def main(arguments: Sequence[str]) -> int:
    """Run the study where it was not, start MLflow, and take the pictures."""
    os.chdir(arguments[0])
    if not Path("results/comparison/report.html").is_file():
        run_all()
    command = [sys.executable, "-m", "palpate.cli.main", "ui", "--port", str(PORT)]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)
    assert server.stdout is not None
    try:
        next(line for line in server.stdout if line.startswith("Ctrl-C"))  # it answers
        pictures(f"http://127.0.0.1:{PORT}")
    finally:
        os.killpg(server.pid, 15)
        server.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
