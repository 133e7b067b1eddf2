"""The comparison of runs that a terminal shows: one row a set of recordings and execution, from the store of MLflow."""

from __future__ import annotations

import datetime
from pathlib import Path

import pandas as pd

from palpate.output.rounding import rounded
from palpate.workflow_support.run_records import ANSWERS
from palpate.workflow_support.tracking import MATERIAL, connected, experiments

ERRORS = {"held_out_nm": "held-out [nm]", "before_held_out_nm": "before [nm]", "noise_nm": "noise [nm]"}
ABOUT = {"kernel": "kernel", "law": "law"}


def table(results: Path) -> pd.DataFrame:
    """Return study, time, recordings, verdict, errors, material parameters, error of the surrogates, kernel and law.

    Parameters
    ----------
    results
        The folder of results.

    Raises
    ------
    InputError
        When there is no store yet.
    """
    client, rows = connected(results), []
    for study, identity in experiments(results).items():
        for run in client.search_runs([identity], f"tags.kind = '{ANSWERS}'", order_by=["attributes.start_time DESC"]):
            metrics, params, tags = run.data.metrics, run.data.params, run.data.tags
            moment = datetime.datetime.fromtimestamp(run.info.start_time / 1000)
            row = {"study": study, "began": f"{moment:%m-%d %H:%M}", "recordings": tags.get("recordings", "")}
            row |= {"verdict": tags.get("verdict", ""), "effects": tags.get("mechanisms", "")}
            row |= {words: rounded(metrics[key], 2) for key, words in ERRORS.items() if key in metrics}
            row |= {key: rounded(value) for key, value in metrics.items() if key in MATERIAL}
            row |= {"surrogate [nm]": rounded(metrics["surrogate_nm"], 2)} if "surrogate_nm" in metrics else {}
            rows.append(row | {words: params[key] for key, words in ABOUT.items() if key in params})
    return pd.DataFrame(rows).fillna("")
