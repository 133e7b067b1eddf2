"""What the documents say of the default study is what its files in docs/data hold, and what a run of it gives."""

import hashlib
import json
from pathlib import Path

import pytest
import yaml
from documents import DOCS, HOOKS

from palpate.base.rounding import interval_of
from palpate.cli.main import main

ROOT = Path(__file__).parents[2]
SHARE = 0.1  # of an interval, by which a run may differ: Numba and BLAS round differently from machine to machine


def checksum(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def answer():
    return json.loads((DOCS / "data/epon862.json").read_text())["sets"][0]


def quantities(found):
    return {entry["name"]: entry for entry in (*found["effects"], *found["parameters"])}


def differing(stored, found):
    """Return the quantities of two answers that differ by more than a share of the stored interval."""
    of_it = quantities(found)
    names = [name for name in quantities(stored) if name not in of_it]
    for name, entry in quantities(stored).items():
        width = entry["upper"] - entry["lower"]
        ends = ("estimate", "lower", "upper")
        if name in of_it and any(abs(of_it[name][end] - entry[end]) > SHARE * width for end in ends):
            names.append(name)
    return names


def test_figures_and_answer_of_the_documents_are_of_one_run():
    content = json.loads((DOCS / "data/epon862_figures.json").read_text())
    assert content["answer"] == checksum(DOCS / "data/epon862.json")
    for name, figure in content["figures"].items():
        assert checksum(DOCS / f"images/epoxy_{name}.svg") == figure["sha256"], name


def test_the_pages_state_the_values_of_the_file():
    page = HOOKS.expanded((DOCS / "epoxy_study.md").read_text())
    for name, entry in quantities(answer()).items():
        assert f"`{name}`" in page and interval_of(entry) in page
    first = HOOKS.expanded((DOCS / "index.md").read_text())
    assert interval_of(answer()["parameters"][0]) in first
    assert all(f"{value:.1f} nm" in page for value in answer()["held_out"].values())


def test_the_readme_states_the_truth_of_the_configuration():
    laboratory = yaml.safe_load((ROOT / "config/config.yaml").read_text())["laboratory"]["virtual"]
    drift, modulus = laboratory["mechanisms"]["thermal_drift"]["rate"], laboratory["parameters"]["youngs_modulus"]
    text = " ".join((ROOT / "README.md").read_text().split())
    assert f"a thermal drift of {drift:g} nm/s and a modulus of {modulus:g} GPa" in text


def test_a_difference_of_a_tenth_of_the_interval_is_noticed():
    stored = answer()
    moved = json.loads(json.dumps(stored))
    entry = moved["parameters"][0]
    entry["estimate"] += 0.2 * (entry["upper"] - entry["lower"])
    assert differing(stored, stored) == [] and differing(stored, moved) == [entry["name"]]
    assert differing(stored, moved | {"effects": []})[: len(stored["effects"])] == [
        e["name"] for e in stored["effects"]
    ]


@pytest.mark.slow
def test_a_run_gives_what_the_documents_state(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    assert main(["run", str(ROOT / "config/config.yaml")]) == 0
    folder = tmp_path / "results/epon862"
    found = json.loads((folder / "report.json").read_text())["sets"][0]
    assert (found["verdict"], found["mechanisms"]) == (answer()["verdict"], answer()["mechanisms"])
    assert differing(answer(), found) == []
    assert json.loads((folder / "tracking/receipt.json").read_text())["status"] == "sent"
