"""From the files of a study to the diagnosis of one set of recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from indentation_files.recording import Recording
from palpate.base.threads import on_one_thread
from palpate.configuration.study_file import Study
from palpate.data.study_recordings import check, files_of, resampled
from palpate.diagnosis.candidates import candidates
from palpate.diagnosis.constraints import ExactLaws, zero_points
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.diagnosis_result import to_mapping
from palpate.diagnosis.instrument_posterior import instrument_posterior
from palpate.diagnosis.model_free import model_free
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.search import Search
from palpate.diagnosis.summary_text import sentence
from palpate.diagnosis.undetected import joint_intervals, undetected_effects, wide_intervals
from palpate.errors import InputError
from palpate.inference.problem import Problem
from palpate.models.own_loads import raise_failure
from palpate.solver.study_scale import with_contact_sought


def run_diagnosis(
    study: Study,
    recordings: str,
    calibration: Mapping[str, Any] | None = None,
    report: Callable[[str], None] = print,
    threads: int = 1,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose the set of `recordings` of this name, see `diagnosed`; raises `InputError` where they made its prior."""
    if study.instrument:
        study.instrument.check_data(files_of(study, recordings))
    content, curves = diagnosed(study, check(study, recordings), calibration, report, threads)
    return content | {"recordings": recordings}, curves


@on_one_thread
def diagnosed(
    study: Study,
    recorded: Mapping[str, list[Recording]],
    calibration: Mapping[str, Any] | None = None,
    report: Callable[[str], None] = print,
    threads: int = 1,
) -> tuple[dict[str, Any], pd.DataFrame]:
    """Diagnose recordings that are checked already.

    Parameters
    ----------
    study
        The study.
    recorded
        Recordings of each condition, from contact on.
    calibration
        Content of `calibration.json`, where the search begins and from which parameters and discrepancy of the base
        model are repeated; by default the base model is searched for over the ranges.
    report
        Called with one line on the progress.
    threads
        Fits that run at once, each on a core; what is found does not depend on it.

    Returns
    -------
    content, curves
        What `diagnosis.json` holds, and the curves before and after beside the recorded ones.

    Raises
    ------
    InputError
        When tests have loads of their own, and no calibration is given.
    PalpateError
        When such tests cannot be simulated with these, or the forward model fails wherever a search may begin.
    """
    rng = np.random.default_rng([study.seed, 1])
    calibrated = {name: row["estimate"] for name, row in calibration["parameters"].items()} if calibration else None
    problem = Problem.of(study, resampled(study, recorded))
    if calibrated is None and any(item.own for item in problem.recorded.values()):
        reason = "tests under loads of their own are compared with the help of the calibrated material"
        raise InputError(reason, remedy="calibrate first, and give its parameters", place="calibration")
    problem = problem.at_one_load(calibrated or {}, raise_failure)
    tests = [test for c in study.calibrated for test in recorded[c.name]]
    problem = replace(problem, scale=with_contact_sought(problem.scale, tests))
    counted = {c.name: [*map(c.counted, recorded[c.name])] for c in study.conditions if not c.part_of}
    pressed = {c.name: counted[c.name] for c in study.conditions if c.name in counted and c.observable.is_depth}
    exact = ExactLaws(study, pressed)
    keys, policy = list(candidates(study)), SearchPolicy(threads=threads)
    search = Search(study, problem, keys, rng, calibrated, exact.beside, policy)
    found = diagnose(search, report)
    own_laws = exact.of_each() if any(candidate.fit.own for candidate in found.accepted) else None
    content, curves = to_mapping(study, problem.observed, found, rng, search.screen, own_laws)
    if calibration:
        content["discrepancy_base"] = calibration["discrepancy"]
        content["parameters"] |= _as_calibrated(content, calibration["parameters"])
    best, explained = found.best.fit, found.verdict != "unexplained"
    content["undetected_effects"] = undetected_effects(best, search.screen.keys) if explained else {}
    content["joint_intervals"] = joint_intervals(best, search.screen) if explained else {}
    content["limits"] += wide_intervals(best, content["joint_intervals"])
    content["study"] = study.name
    if study.instrument:
        content["instrument"] = instrument_posterior(found, search.screen, study.instrument.shares, rng)
    content["model_free"] = [fact.row() for fact in model_free(study, counted, problem.observed)]
    laws = found.base.fit.constraints
    content["laws"] = [law.row() for law in laws]
    following = [c.name for c in study.conditions if c.follows and study.tip_of(c).shape != "sphere"]
    content["zero_points"] = zero_points({name: pressed[name] for name in following if name in pressed}, laws)
    return content | {"sentence": sentence(content)}, curves


def _as_calibrated(content: Mapping[str, Any], parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the parameters of the base model as they were calibrated: one number for one quantity in all files."""
    keys = ("estimate", "lower", "upper", "identified")
    before = {name: {key: parameters[name][key] for key in keys} for name in content["parameters"]["before"]}
    return {"before": before} | ({} if content["candidates"] else {"after": before})
