"""From the files of a study to the diagnosis of one set of recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pandas as pd

from palpate.config import Study
from palpate.diagnosis.design import candidates, scale_of
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.problem import Problem
from palpate.diagnosis.result import to_mapping
from palpate.diagnosis.words import sentence
from palpate.observations import observations


def run_diagnosis(
    study: Study,
    recordings: str,
    base_files: Mapping[str, str | Path],
    effect_files: Mapping[str, str | Path],
    report: Callable[[str], None] = print,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose one set of recordings.

    Returns
    -------
    content, curves
        What `diagnosis.json` holds, and the curves before and after beside the recorded ones.
    """
    observed = observations(study, recordings)
    base = {name: joblib.load(file) for name, file in base_files.items()}
    effects = {name: joblib.load(file) for name, file in effect_files.items()}
    rng = np.random.default_rng([study.seed, 1])
    problem = Problem.of(study, observed, base, effects, scale_of(study))
    found = diagnose(study, problem, list(candidates(study)), rng, report)
    content, curves = to_mapping(study, observed, found, rng)
    content |= {"study": study.name, "recordings": recordings}
    return content | {"sentence": sentence(content)}, curves
