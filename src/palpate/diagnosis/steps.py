"""From the files of a study to the diagnosis of one set of recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pandas as pd

from palpate.calibration import Observation
from palpate.config import Study
from palpate.diagnosis.covariance import varying
from palpate.diagnosis.design import candidates, scale_of
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.exact_laws import ExactLaws
from palpate.diagnosis.hidden import may_hide, not_fixed, open_amplitudes
from palpate.diagnosis.laws import zero_points
from palpate.diagnosis.problem import Problem
from palpate.diagnosis.result import to_mapping
from palpate.diagnosis.words import sentence
from palpate.observations import check, resampled
from palpate.protocol import LOAD


def load_problem(
    study: Study,
    observed: Mapping[str, Observation],
    base_files: Mapping[str, str | Path],
    effect_files: Mapping[str, str | Path],
) -> Problem:
    """Bring the recordings of one set together with the surrogates and effects of the study's calibrate conditions."""
    base = {name: joblib.load(file) for name, file in base_files.items()}
    effects = {name: joblib.load(file) for name, file in effect_files.items()}
    return Problem.of(study, observed, base, effects, scale_of(study))


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
    rng = np.random.default_rng([study.seed, 1])
    recorded = check(study, recordings)
    problem = load_problem(study, resampled(study, recorded), base_files, effect_files)
    pressed = {c.name: recorded[c.name] for c in study.conditions if c.protocol.control == LOAD}
    exact = ExactLaws(study, pressed)
    keys = list(candidates(study))
    found = diagnose(study, problem, keys, rng, report, exact.beside)
    vary = any(varying(candidate.fit.explanation) for candidate in found.standing)
    own_laws = exact.of_each() if vary else None
    content, curves = to_mapping(study, problem.observed, found, rng, own_laws)
    stands = found.standing[0] if found.standing else found.base
    explained = found.verdict != "unexplained"
    content["may_hide"] = may_hide(stands.fit, keys) if explained else {}
    content["open_amplitudes"] = open_amplitudes(stands.fit, keys) if explained else {}
    content["limits"] += not_fixed(stands.fit, content["open_amplitudes"])
    content |= {"study": study.name, "recordings": recordings}
    laws = found.base.fit.laws
    content["laws"] = [law.row() for law in laws]
    following = [c.name for c in study.conditions if c.follows and study.indenter.shape != "sphere"]
    measured = {name: pressed[name] for name in following if name in pressed}
    content["zero_points"] = zero_points(measured, laws)
    return content | {"sentence": sentence(content)}, curves
