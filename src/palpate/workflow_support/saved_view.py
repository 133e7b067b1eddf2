"""What MLflow's page of a study shows: one row a set of recordings, or an explanation, with the columns to compare.

MLflow keeps such a view as a tag of the experiment; a link with its ID opens it, and its menu *Views* lists it. A
version that does not know it shows all runs.
"""

from __future__ import annotations

import base64
import json
import time
import zlib
from collections.abc import Sequence
from typing import Any

from palpate.workflow_support.run_records import ANSWERS

ID, NAME = "palpate", "palpate: sets of recordings"
EXPLANATIONS_ID, EXPLANATIONS_NAME = "palpate-explanations", "palpate: explanations"
MOST = 20_000  # characters that a tag may have
FIRST = ("tags.`verdict`", "metrics.`held_out_nm`", "metrics.`before_held_out_nm`", "metrics.`noise_nm`")
LAST = ("metrics.`surrogate_nm`", "params.`kernel`", "params.`law`", "metrics.`seconds`")
EXPLAINED = (
    "tags.`recordings`", "tags.`mechanisms`", "metrics.`log_evidence`", "metrics.`probability`", "metrics.`fitted_nm`",
)  # fmt: skip
PARAMETERS = 2  # columns of the law's parameters, so that the law itself is seen on a screen of 1600 pixels
WIDTH, WIDE = 100, 140  # pixels of a column, and of one with a long name or long values
LONG = 13  # letters of a long name
LONG_VALUES = ("params.`law`", "tags.`mechanisms`")


def state(parameters: list[str]) -> dict[str, Any]:
    """Return the view of sets of recordings, with columns of some material parameters."""
    columns = [*FIRST, *(f"metrics.`{name}`" for name in parameters[:PARAMETERS]), *LAST]
    return _view(ANSWERS, "attributes.`Created`", columns)


def explanations_state() -> dict[str, Any]:
    """Return the view of explanations, the likeliest first."""
    return _view("explanation", "metrics.`log_evidence`", EXPLAINED)


def _view(kind: str, order: str, columns: Sequence[str]) -> dict[str, Any]:
    """Return a view: which kind of runs, the key that orders them, largest first, and its columns."""
    return {
        "searchFilter": f"tags.kind = '{kind}'",
        "orderByKey": order,
        "orderByAsc": False,
        "selectedColumns": list(columns),
        "columnOrder": list(columns),
        "columnWidths": {name: WIDE if name in LONG_VALUES or _letters(name) > LONG else WIDTH for name in columns},
        "runListHidden": False,
        "viewMaximized": False,
    }


def _letters(column: str) -> int:
    """Return the length of the name that stands above a column, such as ``law`` of ``params.`law```."""
    return len(column.split("`")[1])


def write(client: Any, experiment: str, parameters: list[str]) -> None:
    """Write the views of an experiment over former ones, and have its page open on its runs."""
    now = int(1000 * time.time())
    views = ((ID, NAME, state(parameters)), (EXPLANATIONS_ID, EXPLANATIONS_NAME, explanations_state()))
    for key, name, content in views:
        packed = base64.b64encode(zlib.compress(json.dumps(content).encode(), 9)).decode()
        value = json.dumps({"name": name, "createdAt": now, "updatedAt": now, "state": f"deflate;{packed}"})
        if len(value) < MOST:
            client.set_experiment_tag(experiment, f"mlflow.sharedViewState.{key}", value)
    client.set_experiment_tag(experiment, "mlflow.experimentKind", "custom_model_development")


def link(server: str, experiment: str, view: str = ID) -> str:
    """Return the address of a view of an experiment on a server."""
    return f"{server.rstrip('/')}/#/experiments/{experiment}/runs?viewStateShareKey={view}"
