"""The report and the saved view of MLflow in Chromium: what is seen first, on every screen, without a complaint."""

import base64
import os
import shutil
import subprocess
import sys

import pytest
from results_of import diagnosis, saved
from test_report import page_of

from palpate.cli.main import main
from palpate.cli.ui import _free
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_sets

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
QUIET = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-sync"]
pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def browser():
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sync_playwright = None
    if not (CHROMIUM and sync_playwright):
        reason = "needs Chromium and playwright: pip install -e '.[browser]'"
        pytest.fail(reason) if os.environ.get("CI") == "true" else pytest.skip(reason)
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    page_of(folder, saved(folder, diagnosis()))
    return (folder / "report.html").as_uri()


def opened(browser, address, **settings):
    page = browser.new_page(**settings)
    messages = []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.goto(address)
    return page, messages


def test_the_first_screen_is_the_answer(browser, report):
    page, messages = opened(browser, report, viewport={"width": 1400, "height": 900})
    for text in ("nonlinear Burgers", "Thermal drift identified", "3.30 (3.22 to 3.40)", "What is open"):
        box = page.get_by_text(text).first.bounding_box()
        assert box and box["y"] + box["height"] < 900, text
    assert messages == []


def test_curves_are_drawn_and_another_condition_is_chosen(browser, report):
    page, messages = opened(browser, report)
    page.wait_for_selector(".plot.curve .main-svg")
    names = page.locator(".plot.curve .legendtext").all_text_contents()
    assert {"tests", "recorded, mean", "base model", "accepted model"} <= set(names)
    assert page.locator(".static").first.is_hidden()
    page.select_option("select.condition", "1")
    page.select_option("select.over", "drive")
    assert page.locator(".plot.residual .xtitle").text_content() == "load [mN]"
    assert messages == []


def test_nothing_is_scrolled_sideways_on_a_telephone(browser, report):
    for width in (390, 768, 1400):
        page, _ = opened(browser, report, viewport={"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_light_and_dark_differ(browser, report):
    colours = set()
    for scheme in ("light", "dark"):
        page, _ = opened(browser, report, color_scheme=scheme)
        colours.add(page.evaluate("getComputedStyle(document.body).backgroundColor"))
    assert len(colours) == 2


def test_the_page_reads_without_scripts(browser, report):
    page = browser.new_context(java_script_enabled=False).new_page()
    page.goto(report)
    assert page.locator(".static img").first.is_visible() and page.locator(".plot.curve").is_hidden()


def test_what_is_folded_is_open_in_print(browser, report):
    page, _ = opened(browser, report)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.get_by_text("SHA-256").is_visible()
    assert base64.b64encode(page.pdf())


def test_the_saved_view_of_mlflow_shows_verdict_and_held_out_error(browser, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    (tmp_path / "results/s").mkdir(parents=True)
    with tracked_runs("s", "results/s/tracking/report.json") as record:
        of_sets(record, [saved(tmp_path, diagnosis())], tmp_path / "results/s")
    assert main(["track", "--send"]) == 0
    port = _free(None)
    command = [sys.executable, "-m", "palpate.cli.main", "ui", "--port", str(port)]
    server = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True
    )
    try:
        _, line = server.stdout.readline(), server.stdout.readline()  # the second when MLflow answers
        link = line.split()[-1]
        page, _ = opened(browser, link, viewport={"width": 1700, "height": 800})
        page.wait_for_selector("text=held_out_nm", timeout=60_000)
        page.wait_for_selector("text=5.42", timeout=60_000)
        shown = page.inner_text("body")
        assert "verdict" in shown and "identified" in shown
    finally:
        server.terminate()
        server.wait()
    assert _free(port) == port, "MLflow goes on after the command"
