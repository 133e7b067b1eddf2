"""Runs for MLflow, written to disk first: a job that makes a result never waits for a server.

One JSON file holds the runs of one job, and `palpate.workflow_support.tracking` sends them. All of an execution of the
workflow lie under one parent run. A quantity has one key in every kind of run:

========================  ==============================================================================================
key                       meaning
========================  ==============================================================================================
NAME of a parameter       its estimate, in a run of recordings that of the accepted model
MECHANISM.PARAMETER       amplitude of an effect
held_out_nm               root mean square error of the held-out tests, with the effects; fitted_nm of the fitted ones
before_held_out_nm        the same of the base model, and before_fitted_nm
noise_nm                  noise and scatter of the mean curves
chi2_per_dof              chi-square per degree of freedom of the base model
surrogate_nm              largest leave-one-out error of the surrogates, root mean square over the curve
log_evidence, probability of an explanation; in a run of recordings that of the best one
p_value                   of the base model
inclusion.MECHANISM       probability that it acts; family_inclusion.FAMILY that any of its family does
nothing_further           probability that nothing further acts
uniaxial.TEST.rmse_GPa    root mean square error of a test of the bulk, or rmse_strain; percent_error, within_band
imprint.NAME.rmse_nm      root mean square error of a residual profile, and percent_error of its depth
law_probability           of the law that recordings chose, among those of its family; curves: simulated to choose it
discrepancy               standard deviation of the law's discrepancy, as a share of the depth
========================  ==============================================================================================
"""

from __future__ import annotations

import datetime
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from palpate.inference.calibration_result import rmse
from palpate.observables import UNITS
from palpate.output.results.bulk_errors import bulk_metrics
from palpate.output.results.imprint_errors import imprint_metrics
from palpate.workflow_support.manifest import git_commit
from palpate.workflow_support.result_files import write_json

EXECUTION = "PALPATE_EXECUTION"
MOMENT = "%Y-%m-%d %H:%M:%S"
ROLES = {"validate": "held_out", "calibrate": "fitted"}
ANSWERS, WORKFLOW = "recordings", "workflow"  # kinds of the runs that are compared, and of their parent


@dataclass
class Run:
    """The record for MLflow of one surrogate, fit or explanation, or of a set of recordings.

    Parameters
    ----------
    name, kind
        ``kind`` is ``law``, ``surrogate``, ``calibration``, ``diagnosis``, ``explanation`` or ``recordings``.
    tags, params, metrics
    series
        Metrics with steps 0, 1, ...
    files
        Paths of artifacts.
    tables
        Text of further artifacts, by their names.
    dataset
        Name, digest and folder of the recordings.
    surrogate
        Path of the surrogate, where there is one, and model, the name under which it is logged, with the names of its
        inputs.
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
    tables: dict[str, str] = field(default_factory=dict)
    dataset: dict[str, str] = field(default_factory=dict)
    surrogate: str | None = None
    model: str = ""
    inputs: list[str] = field(default_factory=list)
    started: int = 0
    ended: int = 0


@dataclass
class Record:
    """The runs of one job.

    Parameters
    ----------
    runs
    parent
        Name, tags and metrics of the execution's own run, as far as this job knows them.
    """

    runs: list[Run] = field(default_factory=list)
    parent: dict[str, Any] = field(default_factory=dict)


@contextmanager
def tracked_runs(study: str, file: str | Path) -> Iterator[Record]:
    """Collect the runs of one job, and write them to a file when it has ended well; `study` is the experiment."""
    started, record = now(), Record()
    yield record
    for run in record.runs:
        run.started, run.ended = run.started or started, run.ended or now()
    content = {"study": study, "execution": execution(), "git_commit": git_commit(), **asdict(record)}
    write_json(file, content)


def execution() -> str:
    """Return when the execution of the workflow began."""
    return os.environ.get(EXECUTION, "interactive")


def calibration_metrics(content: Mapping[str, Any]) -> dict[str, float]:
    """Return estimates, errors of the base model by role, misfit and convergence, from the content of a calibration."""
    found = {name: entry["estimate"] for name, entry in content["parameters"].items()} | errors_of_base(content)
    found |= {"chi2_per_dof": content["misfit_ratio"], "converged": float(content["converged"])}
    found |= bulk_metrics(content.get("uniaxial") or {})
    found |= imprint_metrics(content.get("imprint") or {})
    best = [row["best_sum"] for row in content["history"]]
    return found | ({"search_best": min(best)} if best else {})


def errors_of_base(content: Mapping[str, Any]) -> dict[str, float]:
    """Return the errors of the base model, by role and unit, as far as there are any."""
    errors = {(role, unit): rmse(content, role, unit) for role in ROLES for unit in UNITS}
    return {f"before_{ROLES[role]}_{unit}": error for (role, unit), error in errors.items() if error is not None}


def began() -> int | None:
    """Return when the execution began [ms since 1970], if that is known."""
    try:
        return int(1000 * datetime.datetime.strptime(execution(), MOMENT).timestamp())
    except ValueError:
        return None


def now() -> int:
    """Return the time [ms since 1970]."""
    return int(time.time() * 1000)
