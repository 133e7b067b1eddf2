"""The choice of the law in words and as a table, from the content of ``law.json``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from palpate.base.parameters import in_words
from palpate.base.rounding import interval_of, percent
from palpate.materials import law_of

UNDER = "Log evidence with the discrepancy of the law; none where a law could not be fitted."


def choice_sentences(choice: Mapping[str, Any]) -> str:
    """Return how the law was chosen and, where it may well be another one, the answer of that."""
    laws = f"{len(choice['candidates'])} laws of the family {choice['family']}"
    text = f"The recordings {choice['recordings']} chose {law_of(choice['law']).title} among {laws}"
    text += f", with a probability of {percent(choice['probability'])}."
    if second := choice["runner_up"]:
        declared = {p.name: p.unit for p in law_of(second["law"]).parameters}
        values = ", ".join(
            f"{in_words(name)} {interval_of(found)}{'' if declared[name] == '-' else f' {declared[name]}'}"
            for name, found in second["parameters"].items()
        )
        text += f" With {percent(second['probability'])} it is {law_of(second['law']).title}: {values}."
    return text


def choice_table(choice: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a law: probability, log evidence, residual, held-out error and curves."""
    return pd.DataFrame(
        {
            "law": law_of(row["law"]).title,
            "probability": row["probability"],
            "log evidence": row["log_evidence"],
            "residual [nm]": row["residual_nm"],
            "of the depth [%]": row["residual_percent"],
            "held out [nm]": row["held_out_nm"],
            "curves": row["curves"],
        }
        for row in choice["candidates"]
    )
