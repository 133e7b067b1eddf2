"""Two studies on one instrument, one after the other: what the workflow plans, and the virtual laboratory's example."""

import json
from pathlib import Path

import pytest
import yaml
from tiny_study import ROOT, TINY, copied, planned

from palpate.cli.main import main

EXAMPLES = ROOT / "config/instrument"
INSTRUMENT = {"name": "xp", "shares": ["controller_lag"]}
ONE_SET = {key: {"virtual": TINY[key]["virtual"]} for key in ("recordings", "laboratory")}
RECORD = {
    "name": "xp",
    "study": "first",
    "shares": ["controller_lag"],
    "inclusion": {"controller_lag": 0.9},
    "quantities": [{"name": "controller_lag.lag", "unit": "s", "lower": 0.0, "upper": 2.0, "typical": None}],
    "sets": [{"mechanisms": [], "probability": 0.1}, {"mechanisms": ["controller_lag"], "probability": 0.9}],
    "recordings": {},
    "prior": None,
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(copied(tmp_path))
    return tmp_path


def test_what_a_study_finds_of_its_instrument_is_a_result(folder):
    study = TINY | ONE_SET | {"instrument": INSTRUMENT}
    assert "instrument" in planned(folder, study=study)
    assert "instrument" not in planned(folder, study=TINY | ONE_SET)
    assert "instrument" not in planned(folder, study=study | {"diagnosis": {"enabled": False}})


def test_the_prior_of_a_study_is_a_file_that_must_be_there(folder, refused):
    study = TINY | ONE_SET | {"instrument": INSTRUMENT | {"prior": "first"}}
    Path("study.yaml").write_text(yaml.safe_dump(study))
    line = refused("run", "study.yaml")
    assert "study.yaml, instrument.prior: results/first/instrument.json is missing; run the study first" in line
    file = folder / "results/first/instrument.json"
    file.parent.mkdir(parents=True)
    file.write_text(json.dumps(RECORD))
    assert "instrument" in planned(folder, study=study)


def test_check_says_from_where_the_prior_comes(folder, capsys):
    Path("prior.json").write_text(json.dumps(RECORD))
    Path("study.yaml").write_text(yaml.safe_dump(TINY | ONE_SET | {"instrument": INSTRUMENT | {"prior": "prior.json"}}))
    assert main(["check", "study.yaml"]) == 0
    assert "Prior from first on xp, probability that it acts: controller lag 0.9." in capsys.readouterr().out


@pytest.mark.slow
def test_a_film_and_a_frame_are_told_apart_by_two_studies(tmp_path, monkeypatch):
    """A film over a softer solid, or a frame that yields: one study alone does not say which."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    film = yaml.safe_load((EXAMPLES / "virtual_film.yaml").read_text())
    alone = json.loads(json.dumps(film).replace("virtual_film", "alone"))
    del alone["instrument"]["prior"]
    Path("alone.yaml").write_text(yaml.safe_dump(alone))
    for study in (EXAMPLES / "virtual_bulk.yaml", EXAMPLES / "virtual_film.yaml", "alone.yaml"):
        assert main(["run", str(study), "--cores", "2"]) == 0
    found = {
        name: json.loads(Path(f"results/{name}/lab/diagnosis.json").read_text()) for name in ("virtual_film", "alone")
    }
    assert found["alone"]["verdict"] == "ambiguous" and found["alone"]["inclusion"]["frame_compliance"] > 0.5
    assert found["virtual_film"]["verdict"] == "identified"
    assert found["virtual_film"]["mechanisms"] == ["film_on_substrate"]
    record = json.loads(Path("results/virtual_film/instrument.json").read_text())
    assert record["prior"]["study"] == "virtual_bulk" and record["inclusion"]["frame_compliance"] < 0.2
    assert "Prior from virtual_bulk" in Path("results/virtual_film/report.html").read_text()
    assert main(["run", str(EXAMPLES / "virtual_film.yaml"), "--cores", "1"]) == 0
