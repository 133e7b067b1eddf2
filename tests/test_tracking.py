"""Two jobs that log at once lose nothing, and a surrogate comes back from its run."""

import itertools
import multiprocessing
import os

import mlflow
import numpy as np
import pytest

from palpate.errors import PalpateError
from palpate.surrogate import PODRBF

X = np.array(list(itertools.product([1.0, 1.5, 2.0], [0.0, 1.0])))
Y = np.outer(X[:, 0] + X[:, 1] ** 2, np.linspace(1, 2, 5))


def log(folder, number):
    os.chdir(folder)
    os.environ["PALPATE_EXECUTION"] = "one"
    from palpate.workflow_support import tracking

    model = PODRBF().fit(X, Y)
    with tracking.nested_run("s", f"surrogate {number}", "surrogate", folder / "study.yaml", {"number": str(number)}):
        tracking.log_surrogate(model, X, Y, {"loo_rmse_nm": 1.0})
    with tracking.nested_run("s", f"search {number}", "fit", folder / "study.yaml", {}):
        tracking.log_fit({"optimiser": "o"}, {"evaluations": 7.0}, {"best_by_seed": [3.0, 2.0]})


def test_a_series_opens_no_run_of_its_own(tmp_path, monkeypatch):
    from palpate.workflow_support import tracking

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    tracking.connect("s")
    with pytest.raises(PalpateError, match="no run is open to log best to"):
        tracking.log_series("best", [3.0, 2.0], [0, 1])
    assert mlflow.active_run() is None


def test_runs_hold_what_fits_are_compared_by(monkeypatch):
    from palpate.workflow_support import tracking

    params, metrics = {}, {}
    monkeypatch.setattr(mlflow, "log_params", params.update)
    monkeypatch.setattr(mlflow, "log_metrics", metrics.update)
    monkeypatch.setattr(mlflow, "set_tags", lambda tags: None)
    monkeypatch.setattr(tracking, "log_series", lambda *series: None)
    modulus = {"estimate": 3.2, "lower": 3.0, "upper": 3.4, "identified": True}
    errors = {"rmse_nm": 2.0, "r2": 0.99, "mean_abs_error_nm": 1.5, "percent_error": 0.4, "role": "calibrate"}
    calibration = {"parameters": {"youngs_modulus": modulus}, "conditions": {"T030": errors}, "history": []}
    told = {"seed": 862, "misfit_ratio": 1.1, "settled": False}
    tracking.log_calibration(calibration | told, {"population": 200})
    assert params == {"population": 200, "seed": 862}
    assert (metrics["misfit_ratio"], metrics["settled"], metrics["T030.mean_abs_error_nm"]) == (1.1, 0.0, 1.5)
    drift = {"thermal_drift.rate": {"estimate": 0.11, "lower": 0.09, "upper": 0.13}}
    named = {"mechanisms": ["thermal_drift"], "probability": 1.0, "parameters": drift}
    roles = {role: {"before_rmse_nm": 9.0, "after_rmse_nm": None} for role in ("calibrate", "validate")}
    found = {"verdict": "identified", "mechanisms": ["thermal_drift"], "sentence": "", "p_value": 0.002}
    tracking.log_diagnosis(found | {"candidates": [named], "fit": roles | {"noise_nm": 2.0}}, {"snapshots": 40})
    assert params["snapshots"] == 40
    assert (metrics["thermal_drift.rate.estimate"], metrics["thermal_drift.rate.upper"]) == (0.11, 0.13)


def test_the_commit_is_that_of_the_code_wherever_a_study_is_run(tmp_path, monkeypatch):
    from palpate.workflow_support import tracking

    here = tracking.git_commit()
    monkeypatch.chdir(tmp_path)
    assert tracking.git_commit() == here


def test_jobs_that_log_at_once_lose_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    (tmp_path / "study.yaml").write_text("study: s\n")
    context = multiprocessing.get_context("spawn")
    first = context.Process(target=log, args=(tmp_path, 0))
    first.start()
    first.join()
    jobs = [context.Process(target=log, args=(tmp_path, k)) for k in (1, 2, 3)]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    assert [job.exitcode for job in jobs] == [0, 0, 0]
    store = f"sqlite:///{tmp_path}/results/mlflow.db"
    client = mlflow.MlflowClient(store)
    runs = client.search_runs([client.get_experiment_by_name("s").experiment_id])
    surrogates = [run for run in runs if run.data.tags["kind"] == "surrogate"]
    assert len(surrogates) == 4
    assert len({run.data.tags["mlflow.parentRunId"] for run in surrogates}) == 1
    history = client.get_metric_history(surrogates[0].info.run_id, "loo_rms_at_point")
    assert len(history) == 5
    fits = [run for run in runs if run.data.tags["kind"] == "fit"]
    assert [run.data.metrics["evaluations"] for run in fits] == [7.0] * 4
    assert fits[0].data.params["optimiser"] == "o"
    assert [entry.value for entry in client.get_metric_history(fits[0].info.run_id, "best_by_seed")] == [3.0, 2.0]
    mlflow.set_tracking_uri(store)
    models = mlflow.search_logged_models(experiment_ids=[surrogates[0].info.experiment_id], output_format="list")
    assert len(models) == 4
    assert models[0].model_uri
    loaded = mlflow.sklearn.load_model(models[0].model_uri)
    assert np.allclose(loaded.predict(X), Y)
