"""What MLflow's page of a study shows at first: one row a set of recordings, with the columns that are compared.

MLflow keeps such a view as a tag of the experiment, and a link with its ID opens it. A version that does not know it
shows all runs.
"""

from __future__ import annotations

import base64
import json
import time
import zlib
from typing import Any

from palpate.workflow_support.run_records import ANSWERS

ID, NAME = "palpate", "palpate: sets of recordings"
MOST = 20_000  # characters that a tag may have
FIRST = ("tags.`verdict`", "metrics.`held_out_nm`", "metrics.`before_held_out_nm`", "metrics.`noise_nm`")
LAST = ("metrics.`surrogate_nm`", "params.`kernel`", "params.`law`", "metrics.`seconds`")
PARAMETERS = 4  # columns of the law's parameters
WIDTH = 110  # pixels of a column


def state(parameters: list[str]) -> dict[str, Any]:
    """Return the view: filter, order and columns, with those of some material parameters."""
    columns = [*FIRST, *(f"metrics.`{name}`" for name in parameters[:PARAMETERS]), *LAST]
    return {
        "searchFilter": f"tags.kind = '{ANSWERS}'",
        "orderByKey": "attributes.`Created`",
        "orderByAsc": False,
        "selectedColumns": columns,
        "columnOrder": columns,
        "columnWidths": dict.fromkeys(columns, WIDTH),
        "runListHidden": False,
        "viewMaximized": False,
    }


def write(client: Any, experiment: str, parameters: list[str]) -> None:
    """Write the view of an experiment over a former one, and have its page open on its runs."""
    packed = base64.b64encode(zlib.compress(json.dumps(state(parameters)).encode(), 9)).decode()
    now = int(1000 * time.time())
    value = json.dumps({"name": NAME, "createdAt": now, "updatedAt": now, "state": f"deflate;{packed}"})
    if len(value) < MOST:
        client.set_experiment_tag(experiment, f"mlflow.sharedViewState.{ID}", value)
    client.set_experiment_tag(experiment, "mlflow.experimentKind", "custom_model_development")


def link(server: str, experiment: str) -> str:
    """Return the address of the view on a server."""
    return f"{server.rstrip('/')}/#/experiments/{experiment}/runs?viewStateShareKey={ID}"
