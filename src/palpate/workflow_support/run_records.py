"""Runs for MLflow, written to disk first: a job that makes a result never waits for a server.

One JSON file holds the runs of one job, and `palpate.workflow_support.tracking` sends them. All of an execution of the
workflow lie under one parent run, whose name is the time at which the execution began.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from palpate.workflow_support.result_files import write_json

EXECUTION = "PALPATE_EXECUTION"
ROLES = ("calibrate", "validate")
ERRORS = ("rmse_nm", "rmse_mN", "r2", "mean_abs_error_nm", "mean_abs_error_mN", "percent_error")  # mN: as far as given


@dataclass
class Run:
    """The record for MLflow of one surrogate, fit or explanation.

    Parameters
    ----------
    name, kind
        ``kind`` is ``surrogate``, ``calibration``, ``diagnosis`` or ``explanation``.
    tags, params, metrics
    series
        Metrics with steps 0, 1, ...
    files
        Paths of artifacts.
    surrogate
        Path of the surrogate, where there is one.
    started, ended
        Milliseconds since 1970.
    """

    name: str
    kind: str
    tags: dict[str, str] = field(default_factory=dict)
    params: dict[str, Any] = field(default_factory=dict)
    metrics: dict[str, float] = field(default_factory=dict)
    series: dict[str, list[float]] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)
    surrogate: str | None = None
    started: int = 0
    ended: int = 0


@contextmanager
def tracked_runs(study: str, file: str | Path, answer: Mapping[str, Any] | None = None) -> Iterator[list[Run]]:
    """Collect the runs of one job, and write them to a file when it has ended well.

    Parameters
    ----------
    study
        Name of the study, which is the experiment.
    answer
        Tags and metrics of the execution's own run, to be filled in before the job ends.
    """
    started, runs = _now(), list[Run]()
    yield runs
    for run in runs:
        run.started, run.ended = run.started or started, run.ended or _now()
    content = {
        "study": study,
        "execution": os.environ.get(EXECUTION, "interactive"),
        "git_commit": git_commit(),
        "runs": [asdict(run) for run in runs],
        "answer": answer or {},
    }
    write_json(file, content)


def git_commit() -> str:
    """Return the commit of palpate's own working tree, wherever a study is run; ``unknown`` outside a repository."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return answer.stdout.strip()


def of_surrogate(
    condition: str, settings: Mapping[str, Any], levels: Mapping[str, Iterable[float]], summary: Mapping[str, Any]
) -> Run:
    """Return the run of the surrogate of a condition.

    It holds its settings, the levels of the grid, and the summary of `palpate.workflow_support.steps.fit_surrogate`.
    """
    params = dict(settings) | {
        f"levels.{name}": ", ".join(f"{level:g}" for level in row) for name, row in levels.items()
    }
    metrics = {name: float(value) for name, value in summary.items() if isinstance(value, int | float)}
    series = {f"loo_rms_at_point_{summary['unit']}": summary[f"loo_rms_{summary['unit']}"]}
    return Run(f"surrogate {condition}", "surrogate", {"condition": condition}, params, metrics, series)


def of_calibration(result: Mapping[str, Any], settings: Mapping[str, Any], files: Sequence[str | Path]) -> Run:
    """Return the run of a calibration: settings and seed, estimates with intervals, misfit, errors, convergence.

    Errors are given by condition, as in ``P1.00_T030.rmse_nm``, and over all conditions of a role, as in
    ``calibrate.rmse_nm``. The errors of a condition that has the name of a role are ``condition calibrate.rmse_nm``.
    """
    metrics = {"misfit_ratio": result["misfit_ratio"], "converged": float(result["converged"])}
    for name, entry in result["parameters"].items():
        metrics |= {f"{name}.{key}": float(entry[key]) for key in ("estimate", "lower", "upper", "identified")}
    for name, entry in result["conditions"].items():
        label = f"condition {name}" if name in ROLES else name
        metrics |= {f"{label}.{key}": float(entry[key]) for key in ERRORS if key in entry}
    for role, key in itertools.product(ROLES, ("rmse_nm", "rmse_mN")):
        errors = [entry[key] for entry in result["conditions"].values() if entry["role"] == role and key in entry]
        if errors:
            metrics[f"{role}.{key}"] = float(np.sqrt(np.mean(np.square(errors))))
    tags = {"recordings": result["recordings"], "condition_set": result["condition_set"]}
    name = f"fit {result['recordings']} {result['condition_set']}"
    series = {"best_sum_of_objectives": [row["best_sum"] for row in result["history"]]}
    params = {**settings, "seed": result["seed"]}
    return Run(name, "calibration", tags, params, metrics, series, list(map(str, files)))


def of_diagnosis(content: Mapping[str, Any], settings: Mapping[str, Any], files: Sequence[str | Path]) -> list[Run]:
    """Return the run of a diagnosis, and one for every explanation that was fitted.

    The former holds verdict, names, probabilities, gain, p-value and the best explanation's amplitudes; the latter
    evidence, errors before and after, amplitudes and material.
    """
    tags = _verdict(content) | {"mlflow.note.content": content["sentence"]}
    metrics = {"p_value": content["p_value"], "noise_nm": content["fit"]["noise_nm"]}
    metrics |= _errors(content, "calibrate") | _errors(content, "validate")
    for candidate in content["candidates"]:
        metrics["probability." + "-".join(candidate["mechanisms"])] = candidate["probability"]
    for name, found in next(iter(content["candidates"]), {"parameters": {}})["parameters"].items():
        metrics |= {f"{name}.{key}": found[key] for key in ("estimate", "lower", "upper")}
    of = {"recordings": content["recordings"]}
    whole = Run(f"diagnosis {content['recordings']}", "diagnosis", of | tags, dict(settings), metrics)
    whole.files = list(map(str, files))
    return [whole, *(_of_explanation(row, content, of) for row in content["tried"])]


def _of_explanation(row: Mapping[str, Any], content: Mapping[str, Any], of: Mapping[str, str]) -> Run:
    before = next(each["rmse_nm"] for each in content["tried"] if not each["mechanisms"])
    name = "+".join(row["mechanisms"]) or "base model"
    errors = {"before_rmse_nm": before, "after_rmse_nm": row["rmse_nm"]}
    evidence = {"log_evidence": row["log_evidence"], "p_value": row["p_value"]}
    metrics = errors | evidence | row["parameters"] | row["material"]
    return Run(f"explanation {name}", "explanation", {**of, "mechanisms": name}, {}, metrics)


def answer_of(content: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return a diagnosis for an execution's own run: verdict, names and sentence; held-out error and noise."""
    of, tags = content["recordings"], _verdict(content) | {"answer": content["sentence"]}
    metrics = _errors(content, "validate") | {"noise_nm": content["fit"]["noise_nm"]}
    return {
        "tags": {f"{of}.{key}": value for key, value in tags.items()},
        "metrics": {f"{of}.{key}": value for key, value in metrics.items()},
    }


def _verdict(content: Mapping[str, Any]) -> dict[str, str]:
    return {"verdict": content["verdict"], "mechanisms": "+".join(content["mechanisms"]) or "none"}


def _errors(content: Mapping[str, Any], role: str) -> dict[str, float]:
    """Return the errors of one role of conditions, before and after, where there are any."""
    return {f"{role}.{key}": value for key, value in content["fit"][role].items() if value is not None}


def _now() -> int:
    return int(time.time() * 1000)
