"""``palpate runs``: the comparison of runs in the terminal, from the store of MLflow."""

from __future__ import annotations

import argparse
import datetime
from collections.abc import Mapping
from pathlib import Path
from typing import Any

NAME = "runs"
HELP = "compare the runs of studies in the terminal"
ERRORS = {"held_out_nm": "held-out [nm]", "before_held_out_nm": "before [nm]", "noise_nm": "noise [nm]"}
ABOUT = ("kernel", "law")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--results", type=Path, metavar="FOLDER", help="the folder of results (default: results)")


def run(arguments: argparse.Namespace) -> int:
    """Print one row a set of recordings and execution, the latest first.

    Raises
    ------
    InputError
        When there is no store yet.
    """
    import pandas as pd

    from palpate.workflow_support.run_records import ANSWERS
    from palpate.workflow_support.tracking import connected, experiments

    results, rows = arguments.results or Path("results"), []
    studies = experiments(results)
    client = connected(results)
    for study, identity in studies.items():
        found = client.search_runs([identity], f"tags.kind = '{ANSWERS}'", order_by=["attributes.start_time DESC"])
        rows += [{"study": study} | _row(each.info.start_time, each.data) for each in found]
    print(pd.DataFrame(rows).fillna("").to_string(index=False))
    return 0


def _row(began: int, data: Any) -> dict[str, Any]:
    """Return what is compared of a run: time, recordings, verdict, errors, parameters, kernel and law."""
    from palpate.base.rounding import rounded
    from palpate.workflow_support.tracking import MATERIAL

    metrics: Mapping[str, float] = data.metrics
    row = {"began": f"{datetime.datetime.fromtimestamp(began / 1000):%m-%d %H:%M}"}
    row |= {key: data.tags.get(key, "") for key in ("recordings", "verdict", "mechanisms")}
    row |= {words: rounded(metrics[key], 2) for key, words in ERRORS.items() if key in metrics}
    row |= {key: rounded(value) for key, value in metrics.items() if key in MATERIAL}
    row |= {"surrogate [nm]": rounded(metrics["surrogate_nm"], 2)} if "surrogate_nm" in metrics else {}
    return row | {key: data.params[key] for key in ABOUT if key in data.params}
