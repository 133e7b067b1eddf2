"""Runs are written to disk first; sending loses nothing, never waits long, and sends nothing twice."""

import base64
import itertools
import json
import multiprocessing
import os
import re
import socket
import sqlite3
import subprocess
import sys
import threading
import time
import zlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from results_of import diagnosis, saved

from palpate.cli.main import main
from palpate.surrogate import PODRBF
from palpate.surrogate.saved import save
from palpate.workflow_support import saved_view
from palpate.workflow_support.logged_run import log
from palpate.workflow_support.manifest import git_commit
from palpate.workflow_support.run_records import Record, Run, tracked_runs
from palpate.workflow_support.runs_of_results import of_calibration, of_diagnosis, of_sets, of_surrogate
from palpate.workflow_support.tracking import MATERIAL, pending

X = np.array(list(itertools.product([1.0, 1.5, 2.0], [0.0, 1.0])))
VERDICTS = ("identified", "adequate")
Y = np.outer(X[:, 0] + X[:, 1] ** 2, np.linspace(1, 2, 5))


def write_records(folder, execution="one"):
    """Write the records of a surrogate and of another fit, as two jobs do."""
    tracking = folder / "results/s/tracking"
    os.environ["PALPATE_EXECUTION"] = execution
    tracking.mkdir(parents=True, exist_ok=True)
    save(PODRBF().fit(X, Y), X, Y, folder / "results/s/model.npz")
    (folder / "results/s/fit.csv").write_text("a")
    with tracked_runs("s", tracking / "surrogate.json") as record:
        record.runs.append(
            Run("surrogate a", "surrogate", metrics={"loo": 1.0}, series={"by_point.loo_rms_nm": [1.0] * 5})
        )
        record.runs[0].surrogate, record.runs[0].model = "results/s/model.npz", "surrogate P1.00_T030: 5 %"
        record.runs[0].inputs = ["youngs_modulus", "yield_stress"]
    with tracked_runs("s", tracking / "fit.json") as record:
        run = Run("search", "fit", {}, {"optimiser": "o"}, {"evaluations": 7.0}, {"by_seed.best": [3.0, 2.0]})
        run.files, run.tables = ["results/s/fit.csv"], {"errors.csv": "condition,rmse_nm\n"}
        run.dataset = {"name": "lab", "digest": "12345678", "source": "recordings/lab"}
        record.runs.append(run)
        record.parent = {
            "name": "drift identified",
            "tags": {"verdict": "adequate"},
            "params": {},
            "metrics": {"a": 1.0},
        }
    return tracking


def send_from(folder, uri=None):
    """Send what a folder holds; runs in a process of its own."""
    os.chdir(folder)
    os.environ.pop("MLFLOW_TRACKING_URI", None)
    if uri:
        os.environ["MLFLOW_TRACKING_URI"] = uri
    assert main(["track", "--send"]) == 0


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    return tmp_path


def test_one_quantity_has_one_key_in_every_kind_of_run(tmp_path, monkeypatch):
    monkeypatch.setenv("PALPATE_EXECUTION", "2026-11-29 17:13:05")
    found = saved(tmp_path, diagnosis())
    record = Record()
    of_sets(record, [found], tmp_path)
    (answer,) = record.runs
    whole, drift, base = of_diagnosis(found.diagnosis, found.study, [])
    fit = of_calibration(found, "all", [])
    assert answer.name == record.parent["name"] == "thermal drift identified - multiquadric - 17:13"
    assert answer.metrics["youngs_modulus"] == 3.304 and fit.metrics["youngs_modulus"] == 3.978
    assert answer.metrics["held_out_nm"] == whole.metrics["held_out_nm"] == 5.42
    assert answer.metrics["before_held_out_nm"] == fit.metrics["before_held_out_nm"] == 8.61
    assert answer.metrics["thermal_drift.rate"] == drift.metrics["thermal_drift.rate"] == 0.113
    assert (base.name, base.metrics["fitted_nm"]) == ("base model - explanation", 3.7)
    assert fit.metrics["search_best"] == 4.0 and fit.series == {"by_generation.best_sum": [9.0, 4.0, 5.0]}
    assert fit.metrics["surrogate_nm"] == answer.metrics["surrogate_nm"] == 0.05
    assert fit.params["kernel"] == answer.params["kernel"] == "multiquadric"
    assert "rmse_nm" in fit.tables["errors_by_condition.csv"]
    assert answer.tags["mlflow.note.content"] == found.diagnosis["sentence"]
    assert answer.dataset["name"] == "lab" and len(answer.dataset["digest"]) == 8
    keys = set(answer.metrics) | set(answer.params) | set(answer.tags)
    assert len({key[:12] for key in keys}) == len(keys)


def test_a_parent_of_several_sets_counts_their_verdicts(tmp_path):
    record, names = Record(), ("lab", "other")
    found = [saved(tmp_path, diagnosis(verdict), name=name) for verdict, name in zip(VERDICTS, names, strict=True)]
    study = replace(found[0].study, recordings=dict.fromkeys(names, tmp_path))
    of_sets(record, [replace(each, study=study) for each in found], tmp_path)
    assert record.parent["name"].startswith("2 sets: 1 identified, 1 adequate - multiquadric - ")
    assert [run.name.split(":")[0] for run in record.runs] == ["lab", "other"]


def test_later_entries_of_a_diagnosis_become_metrics(tmp_path):
    more = {"nothing_further": {"probability": 0.8}, "discrepancy": {"share": 0.01, "lower": 0.0, "upper": 0.02}}
    more |= {"inclusion": {"friction": 0.2}, "family_inclusion": {"drift": 0.99}, "law_within_tolerance": True}
    record, found = Record(), saved(tmp_path, diagnosis(**more))
    of_sets(record, [found], tmp_path)
    for run in (record.runs[0], of_diagnosis(found.diagnosis, found.study, [])[0]):
        assert (run.metrics["nothing_further"], run.metrics["discrepancy"]) == (0.8, 0.01)
        assert (run.metrics["inclusion.friction"], run.metrics["family_inclusion.drift"]) == (0.2, 0.99)
        assert run.tags["law_within_tolerance"] == "true"


def test_metrics_of_a_named_tip_have_names_that_mlflow_allows():
    batches = []
    client = SimpleNamespace(log_batch=lambda identity, metrics=(), params=(): batches.extend(metrics))
    log(client, "1", {"series": {}, "params": {}, "ended": 0, "metrics": {"tip_rounding[corner].radius": 150.0}})
    assert [(metric.key, metric.value) for metric in batches] == [("tip_rounding.corner.radius", 150.0)]


def test_every_key_that_is_logged_is_explained(tmp_path):
    found = saved(tmp_path, diagnosis(inclusion={"thermal_drift": 1.0}, family_inclusion={"drift": 1.0}))
    record = Record()
    of_sets(record, [found], tmp_path)
    runs = [*record.runs, of_calibration(found, "all", []), *of_diagnosis(found.diagnosis, found.study, [])]
    explained = set(re.findall(r"`([\w.]+)`", (Path(__file__).parents[2] / "docs/tracking.md").read_text()))
    assert {key for run in runs for key in run.metrics} - MATERIAL <= explained


def test_a_surrogate_s_run_names_condition_and_kernel(tmp_path):
    found = saved(tmp_path)
    summary = {"unit": "mN", "loo_rmse_mN": 0.1, "loo_rms_mN": [0.1, 0.2]}
    run = of_surrogate(found.study, "A", PODRBF(), summary)
    assert (run.name, run.model) == ("surrogate 1 mN, 30 s - multiquadric", "surrogate A multiquadric")
    assert run.metrics["surrogate_mN"] == 0.1 and run.series == {"by_point.loo_rms_mN": [0.1, 0.2]}


def test_the_saved_view_is_small_and_shows_verdict_and_error():
    view = saved_view.state(["youngs_modulus"])
    assert {"tags.`verdict`", "metrics.`held_out_nm`", "metrics.`youngs_modulus`"} <= set(view["selectedColumns"])
    names = [column.split("`")[1][:12] for column in view["selectedColumns"]]
    assert len(set(names)) == len(names)


def test_the_commit_is_that_of_the_code_wherever_a_study_is_run(tmp_path, monkeypatch):
    at_home = git_commit()
    monkeypatch.chdir(tmp_path)
    assert git_commit() == at_home


def test_what_was_recorded_arrives_once(here, capsys):
    import mlflow

    write_records(here)
    assert main(["track"]) == 1
    assert "s: 2 records are on disk only" in capsys.readouterr().out
    for _ in range(2):
        assert main(["track", "--send"]) == 0
    store = f"sqlite:///{here}/results/mlflow.db"
    client = mlflow.MlflowClient(store)
    runs = client.search_runs([client.get_experiment_by_name("s").experiment_id])
    by_kind = {run.data.tags["kind"]: run for run in runs}
    assert sorted(run.data.tags["kind"] for run in runs) == ["fit", "surrogate", "workflow"]
    parent = by_kind["workflow"].info.run_id
    assert {by_kind[kind].data.tags["mlflow.parentRunId"] for kind in ("fit", "surrogate")} == {parent}
    whole = by_kind["workflow"]
    assert (whole.info.run_name, whole.data.tags["verdict"], whole.data.metrics["a"]) == (
        "drift identified",
        "adequate",
        1.0,
    )
    fit = by_kind["fit"]
    assert (fit.data.params["optimiser"], fit.data.metrics["evaluations"]) == ("o", 7.0)
    assert [entry.value for entry in client.get_metric_history(fit.info.run_id, "by_seed.best")] == [3.0, 2.0]
    assert fit.inputs.dataset_inputs[0].dataset.name == "lab"
    mlflow.set_tracking_uri(store)
    (model,) = mlflow.search_logged_models(experiment_ids=[fit.info.experiment_id], output_format="list")
    assert np.allclose(mlflow.sklearn.load_model(model.model_uri).predict(X), Y)
    assert model.name == "surrogate P1_00_T030_ 5 _" and mlflow.models.get_model_info(model.model_uri).signature
    loaded = mlflow.pyfunc.load_model(model.model_uri)
    assert list(loaded.input_example) == ["youngs_modulus", "yield_stress"]
    assert loaded.predict(loaded.input_example).shape == (1, Y.shape[1])
    tags = client.get_experiment(fit.info.experiment_id).tags
    envelope = json.loads(tags["mlflow.sharedViewState.palpate"])
    assert len(tags["mlflow.sharedViewState.palpate"]) < 20_000 and envelope["state"].startswith("deflate;")
    state = json.loads(zlib.decompress(base64.b64decode(envelope["state"].removeprefix("deflate;"))))
    assert state["searchFilter"] == "tags.kind = 'recordings'"


def runs_in(store):
    """Return the client of a store, and the runs of the experiment `s` by name."""
    import mlflow

    client = mlflow.MlflowClient(store)
    found = client.search_runs([client.get_experiment_by_name("s").experiment_id])
    names = {run.info.run_name: run for run in found}
    assert len(names) == len(found)
    return client, names


def test_records_are_sent_from_any_folder_with_their_artifacts(here):
    write_records(here / "study")
    results = here / "study/results"
    assert main(["track", "--send", "--results", str(results)]) == 0
    client, runs = runs_in(f"sqlite:///{results}/mlflow.db")
    assert [file.path for file in client.list_artifacts(runs["search"].info.run_id)] == ["errors.csv", "fit.csv"]
    assert (results / "mlartifacts/s").is_dir()
    assert [file.name for file in here.iterdir()] == ["study"]


@pytest.mark.faults(before="counted as sent, without the file")
def test_a_missing_artifact_is_named_and_its_record_is_not_counted_as_sent(here, capsys):
    folder = write_records(here)
    (here / "results/s/fit.csv").unlink()
    assert main(["track", "--send"]) == 1
    line, left = capsys.readouterr().out.splitlines()
    assert f"({here}/results/s/fit.csv is missing: run the study again)" in line
    assert left == "s: 2 records are on disk only"
    assert pending(folder) == ["fit.json", "surrogate.json"]


@pytest.mark.faults(before="the first run arrived twice")
@pytest.mark.parametrize("call", ["create_run", "log_batch"])
def test_a_record_that_was_sent_in_part_is_completed(here, monkeypatch, call):
    """A server fails at the last of three runs: before it is made, or before it is filled."""
    import mlflow

    folder = here / "results/s/tracking"
    monkeypatch.setenv("PALPATE_EXECUTION", "one")
    with tracked_runs("s", folder / "fit.json") as record:
        record.runs += [Run(name, "fit", metrics={"evaluations": 7.0}) for name in ("a", "b", "c")]
    answer, asked = getattr(mlflow.MlflowClient, call), []

    def failing(*arguments, **named):
        asked.append(1)
        if len(asked) == (4 if call == "create_run" else 3):  # the execution's own run is made first
            raise ConnectionError("no answer")
        return answer(*arguments, **named)

    monkeypatch.setattr(mlflow.MlflowClient, call, failing)
    store = ["--results", str(here / "results")]
    assert main(["track", "--send", *store]) == 1
    assert main(["track", "--send", *store]) == 0
    _, found = runs_in(f"sqlite:///{here}/results/mlflow.db")
    assert sorted(found) == ["a", "b", "c", "workflow one"]
    assert all(found[name].data.metrics["evaluations"] == 7.0 for name in "abc")
    assert {run.info.status for run in found.values()} == {"FINISHED"}


def at_once(*jobs):
    """Call `send_from` with each of these arguments, in processes of their own."""
    started = [multiprocessing.get_context("spawn").Process(target=send_from, args=job) for job in jobs]
    for process in started:
        process.start()
    for process in started:
        process.join()
    assert [process.exitcode for process in started] == [0] * len(started)


@pytest.mark.faults(before="every run arrived twice")
@pytest.mark.slow
def test_two_processes_that_send_the_same_records_send_them_once(here):
    write_records(here)
    at_once((here,), (here,))
    assert len(runs_in(f"sqlite:///{here}/results/mlflow.db")[1]) == 3


@pytest.mark.faults(before="no run of eight writers arrived")
@pytest.mark.slow
def test_four_folders_that_share_a_fresh_store_lose_nothing(tmp_path):
    import mlflow

    uri = f"sqlite:///{tmp_path}/shared.db"
    folders = [tmp_path / str(number) for number in range(4)]
    for folder in folders:
        write_records(folder, execution=folder.name)
    at_once(*((folder, uri) for folder in folders))
    client = mlflow.MlflowClient(uri)
    runs = client.search_runs([client.get_experiment_by_name("s").experiment_id])
    assert len(runs) == 12


@pytest.fixture(params=["refuses", "never answers"])
def server(request):
    """Return the address of a server that is of no use."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        if request.param == "never answers":
            listener.listen()
            threading.Thread(target=_accept, args=(listener,), daemon=True).start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"


def _accept(listener):
    kept = []
    while True:
        try:
            kept.append(listener.accept())
        except OSError:
            return


@pytest.mark.faults(before="4 min 20 s of silence, a traceback, the study stopped")
@pytest.mark.slow
def test_a_server_of_no_use_costs_seconds_and_loses_nothing(here, server, capsys, monkeypatch):
    write_records(here)
    monkeypatch.setenv("MLFLOW_TRACKING_URI", server)
    began = time.monotonic()
    assert main(["track", "--send"]) == 1
    assert time.monotonic() - began < 40.0
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 2
    assert said[0].startswith("tracking: 2 records stay on disk") and said[0].endswith(
        "palpate track --send sends them"
    )
    monkeypatch.delenv("MLFLOW_TRACKING_URI")
    assert main(["track", "--send"]) == 0


def sent_apart(folder, uri=None):
    """Return the exit code and what `palpate track --send` prints; MLflow looks at a store only once in a process."""
    kept = {key: value for key, value in os.environ.items() if key != "MLFLOW_TRACKING_URI"}
    command = [sys.executable, "-m", "palpate.cli.main", "track", "--send"]
    environment = kept | ({"MLFLOW_TRACKING_URI": uri} if uri else {})
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert run.stderr == ""
    return run.returncode, run.stdout.splitlines()


def assert_named(told, problem):
    code, (line, left) = told
    assert (code, left) == (1, "s: 2 records are on disk only")
    assert line == f"tracking: 2 records stay on disk ({problem}); palpate track --send sends them"


@pytest.mark.faults(before="a page of traceback, results removed")
@pytest.mark.slow
def test_a_store_of_another_version_is_named_with_the_remedy_and_loses_nothing(here):
    write_records(here)
    assert sent_apart(here)[0] == 0
    store = sqlite3.connect(here / "results/mlflow.db")
    (version,) = store.execute("select version_num from alembic_version").fetchone()
    store.execute("update alembic_version set version_num = '0123456789ab'")
    store.commit()
    store.close()
    write_records(here, "two")
    remedy = "move it away, or if it is older run mlflow db upgrade sqlite:///results/mlflow.db"
    differs = f"schema 0123456789ab where {version} is expected"
    assert_named(sent_apart(here), f"results/mlflow.db is of another version of MLflow, {differs}: {remedy}")


@pytest.mark.faults(before="a traceback")
def test_a_folder_for_a_store_is_named_with_the_remedy(here):
    write_records(here)
    remedy = "name a server or sqlite:///results/mlflow.db"
    problem = f"MLFLOW_TRACKING_URI is ./mlruns, a folder, which MLflow writes no more: {remedy}"
    assert_named(sent_apart(here, "./mlruns"), problem)


@pytest.mark.faults(before="minutes of silence, or no remedy")
@pytest.mark.parametrize("kind", ["no database", "folder", "loop"])
def test_a_file_that_is_no_store_is_named_soon_and_loses_nothing(here, kind, capsys):
    write_records(here)
    file, began = here / "results/mlflow.db", time.monotonic()
    if kind == "no database":
        file.write_bytes(b"no database" * 100)
    elif kind == "folder":
        file.mkdir()
    else:
        file.symlink_to(file.name)
    assert main(["track", "--send"]) == 1
    line, left = capsys.readouterr().out.splitlines()
    assert "results/mlflow.db cannot be read as a database" in line and "move it away" in line
    assert left == "s: 2 records are on disk only"
    assert time.monotonic() - began < 30.0


@pytest.mark.faults(before="the study stopped over it")
@pytest.mark.parametrize("left", ["", "{", "[1]"])
def test_a_damaged_list_of_what_was_sent_costs_no_run(here, left, capsys):
    (write_records(here) / "sent.json").write_text(left)
    assert main(["track"]) == 1
    assert "s: 2 records are on disk only" in capsys.readouterr().out


def test_a_record_that_changed_is_sent_again(here):
    folder = write_records(here)
    assert main(["track", "--send"]) == 0
    record = json.loads((folder / "fit.json").read_text())
    (folder / "fit.json").write_text(json.dumps(record | {"execution": "two"}))
    assert main(["track"]) == 1
