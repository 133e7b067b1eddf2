"""The diagnosis of one set by the code of a study's, and what it states; the truth is not read before."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from palpate.configuration.study_file import Study
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.diagnosis_result import material_parameters, mechanism_parameters, over_all_sets
from palpate.diagnosis.law_class import discrepancy
from palpate.diagnosis.nothing_further import SHOWN, nothing_further
from palpate.diagnosis.search import Search
from palpate.inference.problem import Problem
from palpate.mechanisms import Scale
from studies.claims.body import KEYS, BodyWithMechanisms
from studies.claims.sets import Case, recordings
from studies.coverage.creep import HALF_ANGLE
from studies.coverage.solid import MATERIAL

MODULUS, PRESSURE = 3.0, 0.2  # GPa, of the middle of the ranges


def diagnosed(case: Case, study: Study) -> dict[str, Any]:
    """Return what a diagnosis with the settings of a study states of a set, and its seconds of processor time."""
    begun = time.process_time()
    problem = posed(case)
    own = replace(
        study, conditions=case.conditions, calibration=study.calibration.model_copy(update={"solver_error": 0.0})
    )
    search = Search(own, problem, KEYS, np.random.default_rng(case.seed))
    found = diagnose(search, lambda line: None)
    best, draws = found.best.fit, found.best.draws
    law = discrepancy(best) or {}
    named = frozenset(best.explanation)
    return {
        "name": case.name,
        "verdict": found.verdict,
        "law_within_tolerance": str(found.law_within_tolerance),
        "named": sorted(named) if found.verdict == "identified" else [],
        "candidates": [sorted(each.fit.explanation) for each in found.accepted],
        "probability": found.all_sets.get(named, 0.0),
        "inclusion": {key: p for key, p in found.inclusion.items() if p >= SHOWN},
        "family_inclusion": {key: p for key, p in found.family_inclusion.items() if p >= SHOWN},
        "nothing_further": nothing_further(found, search.screen)["probability"],
        "material": material_parameters(best, draws, explained=True),
        "over_all_sets": over_all_sets(found, search.screen, np.random.default_rng(case.seed)),
        "amplitudes": mechanism_parameters(best, draws),
        "law": {name: law[name] for name in ("share", "lower", "upper", "class", "class_probabilities") if name in law},
        "fits": len(found.tried),
        "seconds": time.process_time() - begun,
    }


def posed(case: Case) -> Problem:
    """Return the recordings of a set with the closed form in place of finite elements."""
    model = BodyWithMechanisms(case.conditions)
    (curves,) = model.curves([np.full(len(MATERIAL.free), 0.5)])
    times = [each.protocol.sample_time[-1] for each in case.conditions]
    size = Scale(
        depth=max(float(curve.max()) for curve in curves.values()),  # type: ignore[union-attr]
        load=max(test[0] for test in case.tests),
        modulus=MODULUS,
        duration=float(max(times)),
        loading_time=min(test[1] for test in case.tests),
        half_angle=HALF_ANGLE,
        pressure=PRESSURE,
    )
    return Problem(case.conditions, recordings(case), model, size)  # type: ignore[arg-type]  # nothing is simulated
