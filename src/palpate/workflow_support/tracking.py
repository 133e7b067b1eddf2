"""Sending the records of jobs (`run_records`) to MLflow, with short time-outs; those that cannot be sent stay on disk.

The store is a local SQLite file unless ``MLFLOW_TRACKING_URI`` names another. A fresh one is made once, under a lock
that lies beside it, so that several folders may share one file. What was sent is listed in ``sent.json`` of the study's
folder of records, by checksum: a second run sends nothing twice.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import re
import sqlite3
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from palpate.errors import PalpateError
from palpate.surrogate.saved import load
from palpate.workflow_support.result_files import checksum, read_json, write_json

STORE = "sqlite:///results/mlflow.db"
SECONDS = 5  # that one request may take
PATIENCE = 60  # s, for another process that makes the store
LIMITS = {
    "MLFLOW_HTTP_REQUEST_TIMEOUT": str(SECONDS),
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "0",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "DO_NOT_TRACK": "true",
}


def send(folder: Path) -> list[str]:
    """Send all records below a study's folder of records that have not been sent, and return those that could not be.

    Anything that goes wrong with the server, the store or the network ends the sending with one line of warning.

    Parameters
    ----------
    folder
        Such as ``results/STUDY/tracking``.
    """
    ledger, waiting = folder / "sent.json", pending(folder)
    for number, name in enumerate(waiting):
        try:
            _send(read_json(folder / name))
        except Exception as error:  # a server may answer with anything; results never depend on it
            left, problem = len(waiting) - number, _problem(str(error))
            print(f"tracking: {left} records stay on disk ({problem}); palpate track --send sends them")
            return waiting[number:]
        write_json(ledger, {**_sent(folder), name: checksum(folder / name)})
    return []


def _problem(answer: str) -> str:
    """Return in one line what MLflow answers, with the remedy where the answer has none."""
    uri = _uri()
    if found := re.search(r"schema \(found version (\w+), but expected (\w+)\)", answer):
        return (
            f"{uri.removeprefix('sqlite:///')} is of another version of MLflow, schema {found[1]} where {found[2]} is "
            f"expected: move it away, or if it is older run mlflow db upgrade {uri}"
        )
    if "filesystem tracking backend" in answer:
        return f"MLFLOW_TRACKING_URI is {uri}, a folder, which MLflow writes no more: name a server or {STORE}"
    return " ".join(answer.split())[:200]


def _uri() -> str:
    return os.environ.get("MLFLOW_TRACKING_URI") or STORE


def pending(folder: Path) -> list[str]:
    """Return the names of a study's records that have not been sent, or have changed since."""
    sent = _sent(folder)
    records = sorted(set(folder.rglob("*.json")) - {folder / "sent.json", folder / "receipt.json"})
    names = [str(file.relative_to(folder)) for file in records if file.is_file()]
    return [name for name in names if sent.get(name) != checksum(folder / name)]


def _sent(folder: Path) -> dict[str, Any]:
    """Return the checksum of each record that was sent; of none where that list is damaged, so that no run is lost."""
    with contextlib.suppress(PalpateError, FileNotFoundError):
        found = read_json(folder / "sent.json")
        return found if isinstance(found, dict) else {}
    return {}


def _send(record: Mapping[str, Any]) -> None:
    """Send the runs of one record."""
    uri = _uri()
    _check_file(uri)
    os.environ.update({key: value for key, value in LIMITS.items() if key not in os.environ})
    import mlflow

    logging.getLogger("mlflow").setLevel(logging.ERROR)
    with _alone(uri):
        mlflow.set_tracking_uri(uri)
        client = mlflow.MlflowClient()
        experiment = _experiment(client, record["study"], uri)
        parent = _parent(client, experiment, record)
    for run in record["runs"]:
        tags = {"kind": run["kind"], "mlflow.parentRunId": parent, "git_commit": record["git_commit"], **run["tags"]}
        made = client.create_run(experiment, start_time=run["started"], tags=tags, run_name=run["name"])
        _fill(client, made.info.run_id, run)
        client.set_terminated(made.info.run_id, end_time=run["ended"])
    for key, value in record["answer"].get("tags", {}).items():
        client.set_tag(parent, key, value)
    for key, value in record["answer"].get("metrics", {}).items():
        client.log_metric(parent, key, value)
    if record["runs"]:
        client.set_terminated(parent, end_time=max(run["ended"] for run in record["runs"]))


def _check_file(uri: str) -> None:
    """Refuse a file that is no SQLite database, which MLflow would try to open for minutes; raises `PalpateError`."""
    file = Path(uri.removeprefix("sqlite:///"))
    if not uri.startswith("sqlite:///") or not os.path.lexists(file):
        return
    try:
        with contextlib.closing(sqlite3.connect(file, timeout=SECONDS)) as database:
            database.execute("select count(*) from sqlite_master").fetchone()
    except sqlite3.Error as error:
        remedy = "try again later" if "locked" in str(error) else "move it away, or correct its permissions"
        raise PalpateError(f"{file} cannot be read as a database, {error}: {remedy}") from None


def _experiment(client: Any, study: str, uri: str) -> str:
    """Return the id of the study's experiment, made if there is none."""
    found = client.get_experiment_by_name(study)
    if found is not None:
        return str(found.experiment_id)
    location = (Path("results/mlartifacts") / study).resolve().as_uri() if uri == STORE else None
    return str(client.create_experiment(study, artifact_location=location))


def _parent(client: Any, experiment: str, record: Mapping[str, Any]) -> str:
    """Return the id of the run of the execution that made a record, made if there is none."""
    execution = record["execution"]
    found = client.search_runs([experiment], f"tags.execution = '{execution}' and tags.kind = 'workflow'")
    if found:
        return str(found[0].info.run_id)
    tags = {"execution": execution, "kind": "workflow", "git_commit": record["git_commit"]}
    started = min((run["started"] for run in record["runs"]), default=None)
    return str(
        client.create_run(experiment, start_time=started, tags=tags, run_name=f"workflow {execution}").info.run_id
    )


def _fill(client: Any, identity: str, run: Mapping[str, Any]) -> None:
    """Log what a run holds: parameters, metrics, series, files, and the surrogate as a loadable model."""
    import mlflow
    from mlflow.entities import Metric, Param

    series = {key: list(enumerate(values)) for key, values in run["series"].items()}
    series |= {key: [(0, value)] for key, value in run["metrics"].items()}
    metrics = [Metric(key, float(v), run["ended"], step) for key, values in series.items() for step, v in values]
    for part in _parts(metrics, 1000):
        client.log_batch(identity, metrics=part)
    for part in _parts([Param(key, str(value)) for key, value in run["params"].items()], 100):
        client.log_batch(identity, params=part)
    for file in run["files"]:
        if Path(file).is_file():
            client.log_artifact(identity, file)
    if run["surrogate"] and Path(run["surrogate"]).is_file():
        with mlflow.start_run(run_id=identity):
            mlflow.sklearn.log_model(
                load(run["surrogate"]),
                name="surrogate",
                pip_requirements=["palpate", "scikit-learn", "scipy", "numpy"],
                serialization_format="cloudpickle",
            )


def _parts(entries: list[Any], size: int) -> Iterator[list[Any]]:
    for first in range(0, len(entries), size):
        yield entries[first : first + size]


@contextlib.contextmanager
def _alone(uri: str) -> Iterator[None]:
    """Wait until no other process makes the store: a lock beside an SQLite file, elsewhere one of this machine's user.

    Raises
    ------
    TimeoutError
        When another process holds it for longer than `PATIENCE`.
    """
    if uri.startswith("sqlite:///"):
        lock = Path(uri.removeprefix("sqlite:///") + ".lock")
        lock.parent.mkdir(parents=True, exist_ok=True)
    else:
        name = hashlib.sha256(uri.encode()).hexdigest()[:16]
        lock = Path(tempfile.gettempdir()) / f"palpate-{os.getuid()}-{name}.lock"
    try:
        with FileLock(lock, timeout=PATIENCE):
            yield
    except Timeout as error:
        raise TimeoutError(f"{lock} is held by another process") from error
