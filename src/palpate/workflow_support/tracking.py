"""Everything that MLflow keeps: one parent run for each execution of the workflow, one nested run a surrogate or fit.

The store is a local SQLite file unless ``MLFLOW_TRACKING_URI`` names another. Only the workflow's scripts use this
module.
"""

from __future__ import annotations

import logging
import os
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mlflow
import numpy as np
from filelock import FileLock
from mlflow.entities import Metric
from mlflow.models import infer_signature

from palpate.errors import PalpateError

STORE = "sqlite:///results/mlflow.db"
EXECUTION = "PALPATE_EXECUTION"
LOCK = Path("results/.mlflow.lock")
ERRORS = ("rmse_nm", "r2", "mean_abs_error_nm", "percent_error")


def connect(study: str) -> None:
    """Point MLflow at the store and make sure that the study's experiment exists; safe for several jobs at once."""
    LOCK.parent.mkdir(parents=True, exist_ok=True)
    uri = os.environ.get("MLFLOW_TRACKING_URI")
    mlflow.set_tracking_uri(uri or STORE)
    with FileLock(LOCK):
        if mlflow.get_experiment_by_name(study) is None:
            location = None if uri else (Path("results/mlartifacts") / study).resolve().as_uri()
            mlflow.create_experiment(study, artifact_location=location)
    mlflow.set_experiment(study)


def parent_run(study: str) -> str:
    """Return the id of this execution's parent run, making it if this is the first job to ask."""
    execution = os.environ.get(EXECUTION, "interactive")
    with FileLock(LOCK):
        found = mlflow.search_runs(
            experiment_names=[study],
            filter_string=f"tags.execution = '{execution}' and tags.kind = 'workflow'",
            output_format="list",
        )
        if found:
            return found[0].info.run_id
        run = mlflow.MlflowClient().create_run(
            mlflow.set_experiment(study).experiment_id,
            run_name=f"workflow {execution}",
            tags={"execution": execution, "kind": "workflow", "git_commit": git_commit()},
        )
        mlflow.MlflowClient().set_terminated(run.info.run_id)
        return run.info.run_id


def git_commit() -> str:
    """Return the commit of palpate's own working tree, wherever a study is run; ``unknown`` outside a repository."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return answer.stdout.strip()


@contextmanager
def nested_run(study: str, name: str, kind: str, configuration: Path, tags: Mapping[str, str]) -> Iterator[None]:
    """Open a run under the execution's parent, with the configuration and the commit as tags."""
    connect(study)
    everything = {
        "kind": kind,
        "mlflow.parentRunId": parent_run(study),
        "configuration": str(configuration),
        "git_commit": git_commit(),
        **tags,
    }
    with mlflow.start_run(run_name=name, tags=everything):
        mlflow.log_artifact(str(configuration))
        yield


def log_series(key: str, values: Iterable[float], steps: Iterable[int]) -> None:
    """Log a metric with many steps to the open run in one go; raises `PalpateError` where none is open."""
    run = mlflow.active_run()
    if run is None:
        raise PalpateError(f"no run is open to log {key} to: call this within nested_run")
    now = int(time.time() * 1000)
    metrics = [Metric(key, float(value), now, int(step)) for value, step in zip(values, steps, strict=True)]
    for first in range(0, len(metrics), 1000):
        mlflow.MlflowClient().log_batch(run.info.run_id, metrics=metrics[first : first + 1000])


def log_grid(levels: Mapping[str, Iterable[float]]) -> None:
    """Log the levels of the snapshot grid, so that runs can be compared by them."""
    mlflow.log_params({f"levels.{name}": ", ".join(f"{level:g}" for level in row) for name, row in levels.items()})


def log_surrogate(model: Any, parameters: np.ndarray, curves: np.ndarray, metrics: Mapping[str, float]) -> None:
    """Log a surrogate: its settings, its metrics, its error along the curve, and itself as a loadable model.

    MLflow's advice against pickles of unknown origin, which this one is not, would fill the log of every study.
    """
    mlflow.log_params(model.get_params())
    mlflow.log_metrics(dict(metrics))
    log_series("loo_rms_at_point", model.loo_rms_, range(len(model.loo_rms_)))
    logging.getLogger("mlflow.sklearn").setLevel(logging.ERROR)
    mlflow.sklearn.log_model(
        model,
        name="surrogate",
        signature=infer_signature(parameters[:2], curves[:2]),
        pip_requirements=["palpate", "scikit-learn", "scipy", "numpy"],
        serialization_format="cloudpickle",
    )


def log_calibration(result: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
    """Log a calibration: settings and seed, estimates with intervals, misfit, errors of each condition, convergence."""
    mlflow.log_params({**settings, "seed": result["seed"]})
    metrics: dict[str, float] = {"misfit_ratio": result["misfit_ratio"]}
    if result["settled"] is not None:
        metrics["settled"] = float(result["settled"])
    for name, entry in result["parameters"].items():
        metrics |= {f"{name}.{key}": float(entry[key]) for key in ("estimate", "lower", "upper", "identified")}
    for name, entry in result["conditions"].items():
        metrics |= {f"{name}.{key}": float(entry[key]) for key in ERRORS}
    for role in ("calibrate", "validate"):
        errors = [entry["rmse_nm"] for entry in result["conditions"].values() if entry["role"] == role]
        if errors:
            metrics[f"{role}.rmse_nm"] = float(np.sqrt(np.mean(np.square(errors))))
    mlflow.log_metrics(metrics)
    generations = [row["generation"] for row in result["history"]]
    log_series("best_sum_of_objectives", [row["best_sum"] for row in result["history"]], generations)


def log_fit(settings: Mapping[str, Any], metrics: Mapping[str, float], series: Mapping[str, Iterable[float]]) -> None:
    """Log any other fit: settings, figures of merit, and figures of repeated fits as metrics with steps."""
    mlflow.log_params(dict(settings))
    mlflow.log_metrics(dict(metrics))
    for key, values in series.items():
        values = list(values)
        log_series(key, values, range(len(values)))


def log_diagnosis(content: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
    """Log a diagnosis: settings, verdict and names as tags, probabilities, gain, p-value, and the best's amplitudes."""
    mlflow.log_params(dict(settings))
    names = "+".join(content["mechanisms"]) or "none"
    mlflow.set_tags({"verdict": content["verdict"], "mechanisms": names, "mlflow.note.content": content["sentence"]})
    metrics = {"p_value": content["p_value"], "noise_nm": content["fit"]["noise_nm"]}
    for role in ("calibrate", "validate"):
        metrics |= {f"{role}.{k}": v for k, v in content["fit"][role].items() if v is not None}
    for candidate in content["candidates"]:
        metrics["probability." + "-".join(candidate["mechanisms"])] = candidate["probability"]
    for name, found in next(iter(content["candidates"]), {"parameters": {}})["parameters"].items():
        metrics |= {f"{name}.{key}": found[key] for key in ("estimate", "lower", "upper")}
    mlflow.log_metrics(metrics)


def log_explanations(study: str, content: Mapping[str, Any], configuration: Path, tags: Mapping[str, str]) -> None:
    """Log every explanation that a diagnosis fitted as a run of its own: evidence, errors, amplitudes and material."""
    before = next(row["rmse_nm"] for row in content["tried"] if not row["mechanisms"])
    for row in content["tried"]:
        name = "+".join(row["mechanisms"]) or "base model"
        with nested_run(study, f"explanation {name}", "explanation", configuration, {**tags, "mechanisms": name}):
            errors = {"before_rmse_nm": before, "after_rmse_nm": row["rmse_nm"]}
            evidence = {"log_evidence": row["log_evidence"], "p_value": row["p_value"]}
            mlflow.log_metrics(errors | evidence | row["parameters"] | row["material"])


def log_answer(study: str, recordings: str, content: Mapping[str, Any]) -> None:
    """Log the answer of a diagnosis to the execution's own run: verdict, names, errors, noise, and when it ended."""
    client, run = mlflow.MlflowClient(), parent_run(study)
    names = "+".join(content["mechanisms"]) or "none"
    tags = {"verdict": content["verdict"], "mechanisms": names, "answer": content["sentence"]}
    errors = {f"validate.{k}": v for k, v in content["fit"]["validate"].items() if v is not None}
    for key, value in tags.items():
        client.set_tag(run, f"{recordings}.{key}", value)
    for key, value in (errors | {"noise_nm": content["fit"]["noise_nm"]}).items():
        client.log_metric(run, f"{recordings}.{key}", value)
    client.set_terminated(run)


def log_files(files: Iterable[str | Path]) -> None:
    """Log files as artifacts of the open run."""
    for file in files:
        mlflow.log_artifact(str(file))
