"""Sending the records of jobs (`run_records`) to MLflow, with short time-outs; those that cannot be sent stay on disk.

The store is a SQLite file in the folder of results unless ``MLFLOW_TRACKING_URI`` names another. A fresh one is made
once, under a lock that lies beside it, so that several folders may share one file. Records that were sent are listed
in ``sent.json`` of the study's folder of records, by checksum. Each run in the store is tagged with the checksum of its
record and with its index there: after a failure only those that are missing are sent.
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

from palpate.errors import InputError, PalpateError
from palpate.materials import LAWS
from palpate.workflow_support import saved_view
from palpate.workflow_support.logged_run import fill, log
from palpate.workflow_support.result_files import checksum, read_json, write_json
from palpate.workflow_support.run_records import WORKFLOW

SECONDS = 5  # that one request may take
PATIENCE = 60  # s, for another process that makes the store or sends the same records
MATERIAL = {parameter.name for law in LAWS.values() for parameter in law.parameters}
LIMITS = {
    "MLFLOW_HTTP_REQUEST_TIMEOUT": str(SECONDS),
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "0",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "DO_NOT_TRACK": "true",
}


def send(folder: Path) -> list[str]:
    """Send all records below a study's folder of records that have not been sent, and return those that could not be.

    Anything that goes wrong with the server, the store, the network or an artifact ends the sending with one line of
    warning. A second process that sends the same records waits for the first.

    Parameters
    ----------
    folder
        Such as ``results/STUDY/tracking``.
    """
    results = folder.parents[1]
    try:
        with _alone(folder / "sent.lock"):
            for name in pending(folder):
                digest = checksum(folder / name)  # before it is read: should it change meanwhile, it is sent again
                _send(read_json(folder / name), digest, results)
                write_json(folder / "sent.json", {**_sent(folder), name: digest})
    except Exception as error:  # a server may answer with anything; results never depend on it
        waiting = pending(folder)
        if waiting:
            problem = f"{len(waiting)} records stay on disk ({_problem(str(error), results)})"
            print(f"tracking: {problem}; palpate track --send sends them")
        return waiting
    return []


def _problem(answer: str, results: Path) -> str:
    """Return in one line what MLflow answers, with the remedy where the answer has none."""
    uri = store_of(results)
    if found := re.search(r"schema \(found version (\w+), but expected (\w+)\)", answer):
        return (
            f"{uri.removeprefix('sqlite:///')} is of another version of MLflow, schema {found[1]} where {found[2]} is "
            f"expected: move it away, or if it is older run mlflow db upgrade {uri}"
        )
    if "filesystem tracking backend" in answer:
        remedy = f"name a server or {_default(results)}"
        return f"MLFLOW_TRACKING_URI is {uri}, a folder, which MLflow writes no more: {remedy}"
    return " ".join(answer.split())[:200]


def store_of(results: Path) -> str:
    """Return the address of the store: that of ``MLFLOW_TRACKING_URI``, or that in a folder of results."""
    return os.environ.get("MLFLOW_TRACKING_URI") or _default(results)


def _default(results: Path) -> str:
    """Return the address of the store in a folder of results."""
    return f"sqlite:///{results}/mlflow.db"


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


def _send(record: Mapping[str, Any], digest: str, results: Path) -> None:
    """Send the runs of one record that the store does not hold completely.

    Parameters
    ----------
    record, digest
        The record, and its checksum.
    results
        The folder of all results. Paths of artifacts count from the folder above it, in which the study ran.

    Raises
    ------
    PalpateError
        When an artifact is missing, or the store is no database.
    """
    uri, above = store_of(results), Path(os.path.abspath(results)).parent
    runs = [_located(run, above) for run in record["runs"]]
    with _alone(_lock_of(uri)):
        client = connected(results)
        experiment = _experiment(client, record["study"], results)
        parent = _parent(client, experiment, record)
    shared = {"mlflow.parentRunId": parent, "git_commit": record["git_commit"], "record": digest}
    there = _runs_in_store(client, experiment, digest, len(runs))
    for index, run in enumerate(runs):
        tags = {"kind": run["kind"], **shared, "index_in_record": str(index), **run["tags"]}
        made = there.get(str(index)) or client.create_run(
            experiment, start_time=run["started"], tags=tags, run_name=run["name"]
        )
        if made.info.status != "FINISHED":
            fill(client, made.info.run_id, run)
            client.set_terminated(made.info.run_id, end_time=run["ended"])
    if of_parent := record["parent"]:
        _keep_view(client, experiment, record)
        log(client, parent, {"series": {}, "ended": max(run["ended"] for run in runs), **of_parent})
        for key, value in {**of_parent["tags"], "mlflow.runName": of_parent["name"]}.items():
            client.set_tag(parent, key, value)
    if runs:
        client.set_terminated(parent, end_time=max(run["ended"] for run in runs))


def experiments(results: Path) -> dict[str, str]:
    """Return the ID of the experiment of every study that has sent runs, by its name.

    Raises
    ------
    InputError
        When there is no store yet, or no run in it.
    """
    store = store_of(results)
    file = Path(store.removeprefix("sqlite:///"))
    if store.startswith("sqlite:///") and not file.is_file():
        remedy = "run a study first (palpate run STUDY.yaml), or name its folder with --results"
        raise InputError("holds no runs: the file is missing", remedy=remedy, file=file)
    found = connected(results).search_experiments(order_by=["name ASC"])
    return {each.name: str(each.experiment_id) for each in found if each.name != "Default"}


def _keep_view(client: Any, experiment: str, record: Mapping[str, Any]) -> None:
    """Write the view of an experiment; where that fails, a line says so, and nothing is lost."""
    names = [name for run in record["runs"] for name in run["metrics"] if name in MATERIAL]
    try:
        saved_view.write(client, experiment, list(dict.fromkeys(names)))
    except Exception as error:  # a server may refuse it
        print(f"tracking: the view of {record['study']} was not written ({' '.join(str(error).split())[:120]})")


def connected(results: Path) -> Any:
    """Return a client of the store, which is made where it is missing.

    Raises
    ------
    PalpateError
        When the store is no database.
    """
    uri = store_of(results)
    _check_file(uri)
    os.environ.update({key: value for key, value in LIMITS.items() if key not in os.environ})
    import mlflow

    logging.getLogger("mlflow").setLevel(logging.ERROR)
    mlflow.set_tracking_uri(uri)
    return mlflow.MlflowClient()


def _located(run: Mapping[str, Any], above: Path) -> dict[str, Any]:
    """Return a run with the absolute paths of its artifacts; raises `PalpateError` where one is missing."""
    files, surrogate = [str(above / file) for file in run["files"]], run["surrogate"] and str(above / run["surrogate"])
    for file in filter(None, [*files, surrogate]):
        if not Path(file).is_file():
            raise PalpateError(f"{file} is missing: run the study again")
    return {**run, "files": files, "surrogate": surrogate}


def _runs_in_store(client: Any, experiment: str, digest: str, count: int) -> dict[str, Any]:
    """Return those of the `count` runs of a record that the store holds, by their index."""
    found = client.search_runs([experiment], f"tags.record = '{digest}'", max_results=max(count, 1))
    return {run.data.tags["index_in_record"]: run for run in found}


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


def _experiment(client: Any, study: str, results: Path) -> str:
    """Return the id of the study's experiment, made if there is none."""
    found = client.get_experiment_by_name(study)
    if found is not None:
        return str(found.experiment_id)
    default = store_of(results) == _default(results)
    location = (results / "mlartifacts" / study).resolve().as_uri() if default else None
    return str(client.create_experiment(study, artifact_location=location))


def _parent(client: Any, experiment: str, record: Mapping[str, Any]) -> str:
    """Return the id of the run of the execution that made a record, made if there is none."""
    execution = record["execution"]
    found = client.search_runs([experiment], f"tags.execution = '{execution}' and tags.kind = '{WORKFLOW}'")
    if found:
        return str(found[0].info.run_id)
    tags = {"execution": execution, "kind": WORKFLOW, "git_commit": record["git_commit"]}
    started = min((run["started"] for run in record["runs"]), default=None)
    return str(
        client.create_run(experiment, start_time=started, tags=tags, run_name=f"workflow {execution}").info.run_id
    )


def _lock_of(uri: str) -> Path:
    """Return the lock of a store: beside an SQLite file, elsewhere one of this machine's user."""
    if uri.startswith("sqlite:///"):
        return Path(uri.removeprefix("sqlite:///") + ".lock")
    name = hashlib.sha256(uri.encode()).hexdigest()[:16]
    return Path(tempfile.gettempdir()) / f"palpate-{os.getuid()}-{name}.lock"


@contextlib.contextmanager
def _alone(lock: Path) -> Iterator[None]:
    """Wait until no other process holds a lock.

    Raises
    ------
    TimeoutError
        When another process holds it for longer than `PATIENCE`.
    """
    lock.parent.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(lock, timeout=PATIENCE):
            yield
    except Timeout as error:
        raise TimeoutError(f"{lock} is held by another process") from error
