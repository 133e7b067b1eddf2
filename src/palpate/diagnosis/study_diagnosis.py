"""From the files of a study to the diagnosis of one set of recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from palpate.configuration.study_file import Study
from palpate.diagnosis.candidates import candidates, scale_of, with_contact_sought
from palpate.diagnosis.constraints import zero_points
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.diagnosis_result import to_mapping
from palpate.diagnosis.exact_constraints import ExactLaws
from palpate.diagnosis.problem import Problem
from palpate.diagnosis.search import Search
from palpate.diagnosis.summary_text import sentence
from palpate.diagnosis.undetected import may_hide, not_fixed, open_amplitudes
from palpate.inference.observation import Observation
from palpate.inference.study_recordings import check, resampled
from palpate.inference.surrogate_fit import WeightedFit
from palpate.inference.surrogate_space import Space
from palpate.recordings.recording import Recording
from palpate.study.protocol import LOAD
from palpate.surrogate import PODRBF


def optimum_on_surrogates(
    study: Study, observed: Mapping[str, Observation], models: Mapping[str, PODRBF]
) -> dict[str, float]:
    """Return the material by name at which surrogates, by condition, come nearest to the mean curves."""
    bounds = {name: (min(levels), max(levels)) for name, levels in study.levels.items()}
    space, measured = Space(bounds), {name: observed[name].mean for name in models}
    fit = WeightedFit(space, models, measured, np.eye(sum(map(len, measured.values()))))
    return space.named(fit.solve([np.full(space.dimensions, 0.5)]))


def run_diagnosis(
    study: Study,
    recordings: str,
    starts: Sequence[Mapping[str, float]],
    report: Callable[[str], None] = print,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose one set of recordings.

    Parameters
    ----------
    starts
        Where the base model may lie, such as its calibration: materials by the names of their parameters.

    Returns
    -------
    content, curves
        What `diagnosis.json` holds, and the curves before and after beside the recorded ones.
    """
    content, curves = diagnosed(study, check(study, recordings), starts, report)
    return content | {"recordings": recordings}, curves


def diagnosed(
    study: Study,
    recorded: Mapping[str, list[Recording]],
    starts: Sequence[Mapping[str, float]],
    report: Callable[[str], None] = print,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose recordings that are checked already, by their conditions; arguments and result as `run_diagnosis`."""
    rng = np.random.default_rng([study.seed, 1])
    calibrated = [test for c in study.conditions if c.role == "calibrate" for test in recorded[c.name]]
    scale = with_contact_sought(scale_of(study), calibrated)
    problem = Problem.of(study, resampled(study, recorded), scale)
    pressed = {c.name: recorded[c.name] for c in study.conditions if c.protocol.control == LOAD}
    exact = ExactLaws(study, pressed)
    search = Search(study, problem, list(candidates(study)), rng, starts, exact.beside)
    found = diagnose(search, report)
    own_laws = exact.of_each() if any(candidate.fit.own for candidate in found.accepted) else None
    content, curves = to_mapping(study, problem.observed, found, rng, own_laws)
    best = found.accepted[0] if found.accepted else found.base
    explained = found.verdict != "unexplained"
    content["may_hide"] = may_hide(best.fit, search.screen.keys) if explained else {}
    content["open_amplitudes"] = open_amplitudes(best.fit, search.screen) if explained else {}
    content["limits"] += not_fixed(best.fit, content["open_amplitudes"])
    content["study"] = study.name
    laws = found.base.fit.laws
    content["laws"] = [law.row() for law in laws]
    following = [c.name for c in study.conditions if c.follows and study.indenter.shape != "sphere"]
    measured = {name: pressed[name] for name in following if name in pressed}
    content["zero_points"] = zero_points(measured, laws)
    return content | {"sentence": sentence(content)}, curves
