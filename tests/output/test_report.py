"""The report: its first screen is the answer, it reads without scripts, and it is small enough to be sent."""

import json
import re

import numpy as np
import pandas as pd
import pytest
from results_of import diagnosis, saved

from palpate.output.figures.catalogue import FIGURES
from palpate.output.html_report import table
from palpate.output.report import study_page
from palpate.output.written_figures import shown, stem_of, write_figures

MADE_FROM = {"python": "3", "libraries": {"numpy": "2"}, "git_commit": "abc", "seed": 0, "files": {"a.csv": "0" * 64}}
SNAPSHOTS = pd.DataFrame({"status": ["ok", "failed"]})


def page_of(folder, *sets):
    write_figures(sets, folder / "figures")

    def drawn(name, of):
        figure, of = FIGURES[name], of or sets[0]
        return shown(figure, of, folder / "figures" / f"{stem_of(figure, of)}.svg")

    study_page.write(sets[0].study, sets, drawn, SNAPSHOTS, MADE_FROM, folder / "report.html")
    return (folder / "report.html").read_text()


def without_scripts(page):
    return re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


@pytest.fixture
def page(tmp_path):
    return page_of(tmp_path, saved(tmp_path, diagnosis()))


def test_the_answer_comes_before_anything_else(page):
    first = without_scripts(page).split("<nav")[0]
    words = [
        "nonlinear Burgers",
        "cone",
        "2 replicates each",
        "Thermal drift identified",
        "3.30 (3.22 to 3.40)",
        "3.98",
    ]
    for word in [*words, "8.6 nm without the effects, 5.4 nm with them", "What is open", "synthetic"]:
        assert word in first, word
    assert "surrogate" not in first.split("</style>")[1].lower()


def test_the_page_is_complete_without_scripts_and_small(page):
    shown = without_scripts(page)
    for heading in ("Curves", "Where the base model fails", "Explanations", "Identifiability", "Calibration sets"):
        assert f"<h2>{heading}</h2>" in shown
    assert shown.count("<figure>") == shown.count("<figcaption>") >= 5
    assert all(len(text) > 20 for text in re.findall(r'alt="(.*?)"', shown))
    assert len(page) < 5e6
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    assert len(scripts) == 2 and len(scripts[0]) < 1.5e6
    assert 'name="viewport"' in page and "prefers-color-scheme: dark" in page and "@media print" in page
    assert not re.search(r'(src|href)="https?:', shown)


DRIFTED = {"estimate": 3.304, "lower": 3.22, "upper": 3.40, "identified": True}


def test_curves_on_the_page_are_those_of_the_results(page):
    (data,) = re.findall(r'<script type="application/json" id="curves">(.*?)</script>', page, re.DOTALL)
    (first, second) = json.loads(data)["lab"]
    assert (first["label"], second["label"], second["role"]) == ("1 mN, 30 s", "0.5 mN, 30 s", "held out")
    assert len(first["tests"]) == 2 and set(first["left"]) == {"base", "accepted", "band"}
    assert first["left"]["accepted"] == pytest.approx([0.5] * len(first["time"]), abs=1e-3)


def test_a_study_of_several_sets_begins_with_a_row_for_each(tmp_path):
    one, other = saved(tmp_path, diagnosis()), saved(tmp_path, diagnosis("adequate"), name="second")
    first = page_of(tmp_path, one, other).split("<nav")[0]
    assert first.count("<tr>") == 3
    assert "Thermal drift identified" in first and "No effect is missing" in first


def test_recordings_without_a_diagnosis_have_a_page(tmp_path):
    page = without_scripts(page_of(tmp_path, saved(tmp_path, synthetic=False)))
    assert "Calibrated, not diagnosed" in page and "Explanations" not in page
    assert "Parameters of the base model" in page


def test_the_first_screen_says_what_is_known_whichever_effects_act(tmp_path):
    page = without_scripts(page_of(tmp_path, saved(tmp_path, diagnosis())))
    assert "whichever effects act (95 %)" in page and "3.31 (3.15 to 3.48)" in page
    older = diagnosis(parameters={when: {"youngs_modulus": DRIFTED} for when in ("before", "after")})
    assert "whichever" not in without_scripts(page_of(tmp_path, saved(tmp_path, older)))


def test_report_json_holds_the_first_screen(tmp_path):
    found = saved(tmp_path, diagnosis())
    content = study_page.report_json(found.study, [found], MADE_FROM)
    assert content["sets"][0]["parameters"][0]["estimate"] == 3.304
    assert content["versions"] == {"python": "3", "numpy": "2", "commit": "abc"}
    json.dumps(content)


def test_headings_are_words_with_units():
    shown = table(pd.DataFrame({"rmse_nm": [1.23456], "condition_set": ["all"], "identified": [True]}))
    assert re.findall("<th.*?>(.*?)</th>", shown.split("thead>")[1]) == ["rmse [nm]", "condition set", "identified"]
    assert re.findall("<td.*?>(.*?)</td>", shown) == ["1.23", "all", "yes"]


def test_tables_show_nothing_where_nothing_is_known_and_units_beside_names():
    shown = table(
        pd.DataFrame([{"name": "a", "unit": "GPa^2", "lower": None}, {"name": "b", "unit": "-", "lower": 1.5}])
    )
    assert re.findall("<td.*?>(.*?)</td>", shown) == ["a [GPa<sup>2</sup>]", "", "b", "1.50"]


def test_a_share_close_to_one_is_not_rounded_to_one():
    assert ">0.999970</td>" in table(pd.DataFrame({"r2": [0.99997]}))
    assert ">1</td>" in table(pd.DataFrame({"r2": [1.0]}))
    assert "nan" not in table(pd.DataFrame({"r2": [np.nan]}))
