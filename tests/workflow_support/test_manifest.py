"""What a report was made from: the recordings of a study with their stiffness, and what changed since."""

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from test_check import ELASTIC

from indentation_files.recording import Recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.data.study_recordings import convert_source, files_of
from palpate.workflow_support import manifest

TIME = np.linspace(0.0, 60.0, 81)
LOAD = np.minimum(TIME / 30.0, 2.0 - TIME / 30.0)
TEST = Recording(TIME, LOAD, 400.0 * np.sqrt(LOAD))
MEASURED = replace(TEST, stiffness=np.full(len(TIME), 0.01))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return the folder of a study with two tests, one with its stiffness, of which a report was made."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").mkdir()
    MEASURED.write_apart("lab/A_1.csv")
    replace(TEST, depth=1.1 * TEST.depth).write("lab/A_2.csv")
    given = ELASTIC | {"recordings": {"lab": "lab"}, "diagnosis": {"enabled": False}}
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(given))
    results = tmp_path / "results/el"
    results.mkdir(parents=True)
    study = load_study("study.yaml")
    files = {name: known for name, known in manifest.of(study, given, results)["files"].items() if known}
    (results / manifest.NAME).write_text(json.dumps({"configuration": given, "files": files}))
    return tmp_path


def told(capsys):
    """Return what `palpate check` names as changed since the report."""
    assert main(["check", "study.yaml"]) == 0
    end = " since results/el/report.html was made: run the study again"
    return [line.removesuffix(end) for line in capsys.readouterr().out.splitlines() if line.endswith(end)]


def test_check_lists_recordings_and_stiffness_that_changed_or_were_deleted(folder, capsys):
    assert told(capsys) == []
    files = ["lab/stiffness/A_1.csv", "lab/A_2.csv"]
    for name in files:
        with (folder / name).open("a") as stream:
            stream.write("# looked at again\n")
    assert told(capsys) == [f"{name} changed" for name in files]
    for name in files:
        (folder / name).unlink()
    assert told(capsys) == [f"{name} was deleted" for name in files]


def test_check_lists_recordings_and_stiffness_that_were_added(folder, capsys):
    replace(MEASURED, depth=1.2 * TEST.depth).write_apart("lab/A_3.csv")
    replace(MEASURED, depth=1.1 * TEST.depth).write_apart("lab/A_2.csv")
    assert told(capsys) == [
        "lab/stiffness/A_2.csv was added", "lab/A_3.csv was added", "lab/stiffness/A_3.csv was added",
    ]  # fmt: skip


@pytest.mark.parametrize("test", [TEST, MEASURED])
def test_the_files_of_a_vendors_file_are_those_that_its_conversion_writes(folder, test):
    test.write("vendor.csv")
    source = {"file": "vendor.csv", "recordings": "lab", "condition": "A"}
    place = "results/el/recordings/lab"
    (folder / "study.yaml").write_text(yaml.safe_dump(ELASTIC | {"recordings": {"lab": place}, "source": source}))
    study = load_study("study.yaml")
    expected = files_of(study, "lab")
    convert_source(study, study.recordings["lab"])
    assert sorted(expected) == sorted(file for file in study.recordings["lab"].rglob("*") if file.is_file())
