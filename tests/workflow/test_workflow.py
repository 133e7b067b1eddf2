"""The workflow from a tiny study to its report, and what it must never do: recompute, lose, or start on bad input."""

import hashlib
import html
import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from tiny_study import ROOT, TINY, copied, execute, planned, snakemake

from indentation_files.recording_file import read_recording
from palpate.configuration.study_file import study_from
from palpate.configuration.study_sections import StudyFile
from palpate.solver.simulation import simulate_batch

PALPATE = Path(sys.executable).parent / "palpate"


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    study = study_from(TINY, "study.yaml")
    simulate_batch([study.specification(cell, study.condition("T030")) for cell in study.cells])  # compiled once
    folder = copied(tmp_path_factory.mktemp("workflow"), "studies")
    run = snakemake(folder)
    assert run.returncode == 0, run.stderr[-3000:]
    return folder


def test_results_are_where_the_contract_says(finished):
    results = finished / "results/tiny"
    calibration = json.loads((results / "virtual/calibration.json").read_text())
    assert set(calibration["conditions"]) == {"T030", "T100", "V030"}
    for entry in calibration["conditions"].values():
        assert {"rmse_nm", "r2", "mean_abs_error_nm", "percent_error", "role"} <= set(entry)
    for entry in calibration["parameters"].values():
        assert {"estimate", "lower", "upper", "identified"} <= set(entry)
    assert (results / "virtual/calibrations/fast.json").exists()
    assert len(pd.read_csv(results / "figures/virtual_misfit_map.csv")) == 8
    answers = json.loads((results / "report.json").read_text())["sets"]
    assert sorted(found["name"] for found in answers) == ["concealed", "virtual"]
    page = (results / "report.html").read_text()
    assert "synthetic" in page
    assert page.count("<figure>") == page.count("<figcaption>") >= 12
    manifest = json.loads((results / "report.manifest.json").read_text())
    assert manifest["configuration"]["study"] == "tiny"
    for file, checksum in manifest["files"].items():
        assert checksum == hashlib.sha256((finished / file).read_bytes()).hexdigest()
        assert checksum in page
    assert json.loads((results / "tracking/receipt.json").read_text())["status"] == "sent"


def test_the_concealed_drift_is_found(finished):
    results = finished / "results/tiny/concealed"
    diagnosis = json.loads((results / "diagnosis.json").read_text())
    assert {"verdict", "p_value", "location", "mechanisms", "candidates", "discriminating_test", "fit"} <= set(
        diagnosis
    )
    assert (diagnosis["verdict"], diagnosis["mechanisms"]) == ("identified", ["thermal_drift"])
    rate = diagnosis["candidates"][0]["parameters"]["thermal_drift.rate"]
    assert rate["lower"] < 0.5 < rate["upper"]
    assert diagnosis["fit"]["validate"]["after_rmse_nm"] < 0.5 * diagnosis["fit"]["validate"]["before_rmse_nm"]
    nothing = json.loads((finished / "results/tiny/virtual/diagnosis.json").read_text())
    assert (nothing["verdict"], nothing["mechanisms"]) == ("adequate", [])
    report = (finished / "results/tiny/report.html").read_text().replace("\N{NO-BREAK SPACE}", " ")
    assert html.escape(diagnosis["sentence"]) in report


def test_estimates_hold_the_truth(finished):
    table = pd.read_csv(finished / "results/tiny/figures/virtual_parameters.csv")
    free = table[(table["fit"] == "base, all") & table["identified"]]
    assert len(free) >= 1
    assert ((free["lower"] <= free["truth"]) & (free["truth"] <= free["upper"])).all()


@pytest.mark.slow
def test_a_blind_trial_goes_from_the_seal_to_its_summary(finished):
    trial = TINY | {"challenge": {"seed": 4, "none": 1, "one": 1, "two": 0, "unknown": 0, "accuracy": "standard"}}
    run = snakemake(finished, "challenge", study=trial)
    assert run.returncode == 0, run.stderr[-3000:]
    folder = finished / "results/tiny/trial"
    checksum = (folder / "checksum.txt").read_text().split()[0]
    assert checksum == hashlib.sha256((folder / "sealed.json").read_bytes()).hexdigest()
    assert sorted(pd.read_csv(folder / "cases.csv")["kind"]) == ["none", "one"]
    assert (folder / "power.png").stat().st_size > 10_000
    assert pd.read_csv(folder / "summary.csv").loc[0, "of"] == 1


def test_every_surrogate_and_fit_is_a_run_under_one_parent(finished):
    import mlflow

    client = mlflow.MlflowClient(f"sqlite:///{finished}/results/mlflow.db")
    experiment = client.get_experiment_by_name("tiny")
    runs = client.search_runs([experiment.experiment_id])
    kinds = Counter(run.data.tags["kind"] for run in runs)
    results = finished / "results/tiny"
    diagnoses = [json.loads((results / f"{name}/diagnosis.json").read_text()) for name in ("virtual", "concealed")]
    fits = {"calibration": 4, "diagnosis": 2, "explanation": sum(len(each["tried"]) for each in diagnoses)}
    assert kinds == {**fits, "surrogate": 2, "recordings": 2, "workflow": 1}
    parent = next(run.info.run_id for run in runs if run.data.tags["kind"] == "workflow")
    assert all(run.data.tags["mlflow.parentRunId"] == parent for run in runs if run.info.run_id != parent)


@pytest.mark.parametrize(
    ("change", "again", "kept"),
    [
        ({"surrogate": {"kernel": "cubic"}}, {"surrogate", "calibration", "report"}, {"laboratory_virtual"}),
        ({"calibration": {"generations": 12}}, {"calibration"}, {"surrogate", "laboratory_virtual"}),
        ({"conditions": TINY["conditions"][:2]}, {"calibration", "laboratory_virtual"}, {"surrogate"}),
        ({"title": "another"}, {"report"}, {"surrogate", "calibration", "diagnosis", "figures"}),
        (
            {"conditions": [condition | {"own_loads": True} for condition in TINY["conditions"]]},
            {"calibration", "calibration_on_all", "diagnosis"},
            {"surrogate", "laboratory_virtual"},
        ),
    ],
)
def test_a_change_reruns_what_rests_on_it_and_nothing_else(finished, change, again, kept):
    rules = planned(finished, study=TINY | change)
    assert again <= rules
    assert not kept & rules
    assert "snapshots" not in rules


@pytest.mark.slow
def test_an_edited_recording_is_calibrated_again(finished):
    """With the stiffness that lies beside."""
    own = finished / "own"
    shutil.copytree(finished / "results/tiny/recordings/virtual", own)
    recording = read_recording(own / "T030_1.csv")
    replace(recording, stiffness=np.full(len(recording), 0.01)).write_apart(own / "T030_1.csv")
    study = TINY | {"recordings": TINY["recordings"] | {"own": "own"}}
    target = "results/tiny/own/calibrations/fast.json"
    run = snakemake(finished, target, study=study)
    assert run.returncode == 0, run.stderr[-3000:]
    assert planned(finished, target, study=study) == set()
    for file in (own / "T030_1.csv", own / "stiffness/T030_1.csv"):
        was, text = file.stat(), file.read_text()
        for again in (text + "# looked at again\n", text):
            file.write_text(again)
            os.utime(file, ns=(was.st_atime_ns, was.st_mtime_ns))  # as a copy that keeps times leaves it
            assert planned(finished, target, study=study) == ({"calibration"} if again != text else set())
    (own / "stiffness/T030_1.csv").unlink()
    assert planned(finished, target, study=study) == {"calibration"}


def test_an_edited_recording_of_the_laboratory_is_calibrated_again_not_written_again(finished, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(finished, copy)
    with (copy / "results/tiny/recordings/virtual/T030_1.csv").open("a") as stream:
        stream.write("# looked at again\n")
    rules = planned(copy, study=TINY)
    assert {"calibration", "main_calibration", "diagnosis", "report", "tracking"} <= rules
    assert not {"laboratory_virtual", "laboratory_concealed", "surrogate"} & rules
    check = subprocess.run([PALPATE, "check", "study.yaml"], cwd=copy, capture_output=True, text=True)
    assert "T030_1.csv changed since results/tiny/report.html was made: run the study again" in check.stdout


def test_nothing_is_left_to_do_where_a_finished_study_was_moved_or_copied(finished, tmp_path):
    shutil.copytree(finished, tmp_path / "elsewhere")
    run = snakemake(tmp_path / "elsewhere", "--dry-run")
    assert "Nothing to be done" in run.stdout + run.stderr
    assert "profiles/default" in run.stdout + run.stderr


def test_keys_of_a_study_may_be_given_on_the_command_line(finished):
    rules = planned(finished, "--config", "seed=7", study=TINY)
    assert "calibration" in rules
    assert not {"snapshots", "surrogate"} & rules


def test_nothing_of_the_default_study_leaks_into_another(tmp_path):
    without = {key: value for key, value in TINY.items() if key not in ("recordings", "laboratory", "condition_sets")}
    rules = planned(copied(tmp_path, "config"), study=without)
    assert rules == {"snapshots", "snapshot_index", "surrogate", "figures", "report", "tracking", "all"}


def test_a_file_without_the_name_of_a_study_is_named(tmp_path):
    without = {key: value for key, value in TINY.items() if key != "study"}
    run = snakemake(copied(tmp_path, "config"), "--dry-run", study=without)
    assert run.returncode == 2
    (line,) = [line for line in run.stderr.splitlines() if line.startswith("palpate:")]
    assert "study.yaml, top level: the key 'study' is missing" in line


def test_the_workflow_is_a_module_of_another(tmp_path):
    workflow = f"""
configfile: "study.yaml"
module indentation:
    snakefile: "{ROOT}/Snakefile"
    config: config
use rule * from indentation as indentation_*
"""
    (tmp_path / "Snakefile").write_text(workflow)
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(TINY))
    run = execute(tmp_path, "indentation_all", "--dry-run")
    assert run.returncode == 0, run.stderr[-3000:]
    assert "indentation_calibration" in run.stdout + run.stderr
    assert "epon862" not in run.stdout + run.stderr


@pytest.mark.slow
def test_lost_tables_come_back_from_the_store(finished):
    run = snakemake(finished, "results/tiny/snapshots.csv")
    assert run.returncode == 0, run.stderr[-3000:]
    table = (finished / "results/tiny/snapshots.csv").read_bytes()
    stored = {file: file.stat().st_mtime_ns for file in (finished / "results/store").rglob("*.npz")}
    shutil.rmtree(finished / "results/tiny/snapshots")
    (finished / "results/tiny/snapshots.csv").unlink()
    run = snakemake(finished, "results/tiny/snapshots.csv")
    assert run.returncode == 0, run.stderr[-3000:]
    assert {file: file.stat().st_mtime_ns for file in (finished / "results/store").rglob("*.npz")} == stored
    assert (finished / "results/tiny/snapshots.csv").read_bytes() == table


@pytest.mark.slow
def test_a_new_level_recomputes_no_snapshot_that_exists(finished):
    store = finished / "results/store"
    before = {file: file.stat().st_mtime_ns for file in store.rglob("*.npz")}
    study = TINY | {"parameters": TINY["parameters"] | {"youngs_modulus": [3.0, 3.25, 3.5]}}
    run = snakemake(finished, "results/tiny/snapshots.csv", study=study)
    assert run.returncode == 0, run.stderr[-3000:]
    after = {file: file.stat().st_mtime_ns for file in store.rglob("*.npz")}
    assert len(set(after) - set(before)) == 4
    assert all(after[file] == time for file, time in before.items())


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"materiall": {}}, ["materiall", "did you mean 'material'"]),
        ({"recordings": TINY["recordings"] | {"own": "missing"}}, ["missing", "folder"]),
    ],
)
def test_bad_input_ends_with_one_line_and_exit_code_two(finished, change, words):
    run = snakemake(finished, study=TINY | change)
    lines = [line for line in run.stderr.splitlines() if line.startswith("palpate:")]
    assert run.returncode == 2
    assert len(lines) == 1
    assert "Traceback" not in run.stderr
    for word in words:
        assert word in lines[0]


@pytest.mark.parametrize(
    ("target", "key", "words"),
    [
        ("real", "data", "the vendor's file nofolder is missing"),
        ("verification", "reference", "palpate: nofolder: the folder is missing; give a folder of curves"),
    ],
)
def test_files_that_are_missing_are_told_before_anything_runs(tmp_path, target, key, words):
    run = execute(copied(tmp_path, "config", "studies"), target, "--dry-run", "--config", f"{key}=nofolder")
    assert run.returncode == 2
    assert words in run.stderr
    assert "Traceback" not in run.stderr


@pytest.mark.parametrize("failed", [0, 1])
@pytest.mark.slow
def test_a_verification_with_failed_checks_ends_with_an_error_and_keeps_its_report(tmp_path, failed):
    results = copied(tmp_path, "config", "studies") / "results/verification"
    results.mkdir(parents=True)
    (results / "report.html").write_text("made before")
    (results / "verification.json").write_text(json.dumps({"checks": 2, "failed": failed}))
    run = execute(tmp_path, "verification", "--config", "quick=false")
    assert run.returncode == failed, run.stderr[-3000:]
    assert ("1 of 2 checks failed; see results/verification/report.html" in run.stderr) == bool(failed)
    assert (results / "report.html").read_text() == "made before"


def test_a_key_on_the_command_line_that_is_neither_true_nor_false_is_refused(tmp_path):
    run = execute(copied(tmp_path, "config", "studies"), "verification", "--dry-run", "--config", "quick=maybe")
    assert run.returncode == 2
    assert run.stderr.splitlines()[-1].startswith("palpate: quick=maybe is neither true nor false")


def test_a_key_on_the_command_line_that_a_study_does_not_know_is_refused(tmp_path):
    run = snakemake(copied(tmp_path), "--dry-run", "--config", "pionts=50")
    assert run.returncode == 2
    assert "pionts" in run.stderr and "did you mean 'points'" in run.stderr


def test_every_key_that_a_rule_takes_from_the_command_line_is_accepted_there(tmp_path):
    """The keys that rules ask for, those that comments and documents name beside a study's, and the message's agree."""
    files = [*(ROOT / "workflow/rules").glob("*.smk"), *(ROOT / "studies").glob("*/*.smk")]
    rules = "".join(file.read_text() for file in files)
    named = [rules, *(file.read_text() for file in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")])]
    asked = set(re.findall(r'config\.get\("(\w+)"\)', rules))
    documented = {
        key
        for text in named
        for keys in re.findall(r"--config((?: \w+=\w+)+)", text)
        for key in re.findall(r"(\w+)=", keys)
    }
    assert documented - (set(StudyFile.model_fields) - asked) == asked
    (tmp_path / "curves").mkdir()
    values = {"data": "none", "quick": "1", "reference": "curves"}
    assert set(values) == asked
    run = execute(
        copied(tmp_path, "config", "studies"), "verification", "--dry-run", "--config", *map("=".join, values.items())
    )
    assert run.returncode == 0, run.stderr
    assert "verification of the solver" in run.stdout + run.stderr


def test_a_study_under_a_pyramid_is_planned_with_its_diagnosis(tmp_path):
    pyramid = {"indenter": {"shape": "berkovich"}, "kinematics": "small"}
    assert {"calibration", "diagnosis"} <= planned(copied(tmp_path), study=TINY | pyramid)
