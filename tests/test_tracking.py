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
    from palpate import tracking

    model = PODRBF().fit(X, Y)
    with tracking.nested_run("s", f"surrogate {number}", "surrogate", folder / "study.yaml", {"number": str(number)}):
        tracking.log_surrogate(model, X, Y, {"loo_rmse_nm": 1.0})
    with tracking.nested_run("s", f"search {number}", "fit", folder / "study.yaml", {}):
        tracking.log_fit({"optimiser": "o"}, {"evaluations": 7.0}, {"best_by_seed": [3.0, 2.0]})


def test_a_series_opens_no_run_of_its_own(tmp_path, monkeypatch):
    from palpate import tracking

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MLFLOW_TRACKING_URI", raising=False)
    tracking.connect("s")
    with pytest.raises(PalpateError, match="no run is open to log best to"):
        tracking.log_series("best", [3.0, 2.0], [0, 1])
    assert mlflow.active_run() is None


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
    history = client.get_metric_history(surrogates[0].info.run_id, "loo_rms_nm_at_point")
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
