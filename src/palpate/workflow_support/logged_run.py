"""What a run of MLflow holds: parameters, metrics, series, dataset, files, and the surrogate as a loadable model."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from palpate.surrogate.saved import load

REFUSED = r"""[/:.%"']"""  # what a model's name may not hold


def log(client: Any, identity: str, run: Mapping[str, Any]) -> None:
    """Log parameters, metrics and series of a run."""
    from mlflow.entities import Metric, Param

    series = {key: list(enumerate(values)) for key, values in run["series"].items()}
    series |= {key: [(0, value)] for key, value in run["metrics"].items()}
    metrics = [
        Metric(_without_brackets(key), float(v), run["ended"], step)
        for key, values in series.items()
        for step, v in values
    ]
    for part in _parts(metrics, 1000):
        client.log_batch(identity, metrics=part)
    for part in _parts([Param(key, str(value)) for key, value in run["params"].items()], 100):
        client.log_batch(identity, params=part)


def _without_brackets(name: str) -> str:
    """Return the name of a metric, in which MLflow allows no brackets: ``KEY.TIP.NAME`` for ``KEY[TIP].NAME``."""
    return name.replace("[", ".").replace("]", "")


def fill(client: Any, identity: str, run: Mapping[str, Any]) -> None:
    """Log what a run holds: parameters, metrics, series, dataset, files, and the surrogate as a loadable model."""
    import mlflow
    import numpy as np
    import pandas as pd

    log(client, identity, run)
    if run["dataset"]:
        client.log_inputs(identity, datasets=[_dataset(run["dataset"])])
    for file in run["files"]:
        folder = "figures" if Path(file).parent.name == "figures" else None
        client.log_artifact(identity, file, folder)
    for name, text in run["tables"].items():
        client.log_text(identity, text, name)
    if run["surrogate"]:
        model = load(run["surrogate"])
        example = pd.DataFrame(model.lower_[None])
        if names := run.get("inputs"):  # a record of a former version has none
            example.columns = pd.Index(names)
            model.feature_names_in_ = np.array(names, dtype=object)
        with mlflow.start_run(run_id=identity):
            mlflow.sklearn.log_model(
                model,
                name=re.sub(REFUSED, "_", run["model"]),
                signature=mlflow.models.infer_signature(example, model.predict(example)),
                input_example=example,
                pip_requirements=["palpate", "scikit-learn", "scipy", "numpy"],
                serialization_format="cloudpickle",
            )


def _dataset(found: Mapping[str, str]) -> Any:
    """Return the recordings of a run as MLflow's input."""
    from mlflow.entities import Dataset, DatasetInput, InputTag

    source = json.dumps({"uri": found["source"]})
    dataset = Dataset(name=found["name"], digest=found["digest"], source_type="local", source=source)
    return DatasetInput(dataset, [InputTag("mlflow.data.context", "recordings")])


def _parts(entries: list[Any], size: int) -> Iterator[list[Any]]:
    for first in range(0, len(entries), size):
        yield entries[first : first + size]
