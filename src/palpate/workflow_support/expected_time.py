"""An estimate of how long a study will take, before it runs: numbers of curves times what one costs.

A calibration simulates curves and derivatives until it has converged, and a diagnosis does so for each explanation;
neither number is known beforehand. The numbers here are those of the epoxy study, of a small study with three
mechanisms, and of a drafted study of a public recording (docs/measurements.md) on a free core, at ``accuracy:
standard``; a study may well take half or twice as long, and a diagnosis of a law with flow that does not suit three
times. Replicates make the noise known, so that a calibration needs one search and few sets of effects remain likely
beside the best one; without them a calibration searches from many places, and a diagnosis fits many sets, as it does
where tests of an elastic law leave an imprint. Under a pyramid snapshots and searches are those of the equivalent cone,
and fits simulate a few curves of the pyramid besides.

On several cores jobs that do not wait for each other run side by side, and a diagnosis begins fits that it may need.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from indentation_files.recording_file import read_recording
from palpate.configuration.study_file import Study
from palpate.data.study_recordings import files_of
from palpate.diagnosis.candidates import candidates
from palpate.materials.families import FAMILIES
from palpate.solver.store import cells_of_a_job, conditions_by_shape

CREEP, PLASTIC, ELASTIC = 0.10, 0.30, 0.09  # s of processor time of one curve of 100 points
GEL = "gel"  # the family without a law that yields
YIELDS = "yield_stress"  # the parameter of bodies that yield
CORNERS = 0.005  # of that, more for each corner of the load beyond those of a trapezoid
CHOICE, OTHER_LAW = 200, 120  # curves of one condition in the fit of the first law of a family, and of each other one
CALIBRATION = 160  # curves of one condition in a calibration with replicates
CALIBRATION_ALONE = 500  # the same without, where searches begin at many places
DIAGNOSIS = 280  # curves of one condition in any diagnosis
EXPLANATION = 14  # further ones for each mechanism that is considered, with replicates
UNSUITED = 180  # the same where the law cannot suit
ALONE = 30  # the same without replicates, where few sets are fitted, but each from several places
IMPRINT = 0.1  # of the largest depth, chosen: what is left beyond it after unloading is no noise, drift or late contact
FURTHER = 0.3  # of that, for each further condition: conditions are solved together
PYRAMID = 21.0 / CREEP  # times that, one curve of the pyramid at few points: of the epoxy 21 s (docs/pyramid.md)
PYRAMIDS = 3  # such curves of one condition, at most in a calibration (docs/pyramid.md), and about in a diagnosis
STANDARD = "standard"  # the accuracy for which these times hold
START = 3.0  # s, until a job has imported what it needs
SURROGATE = 3.5  # s, of the surrogate of one condition
PLANNING = 4.0  # s, of Snakemake itself
DIAGNOSIS_THREADS = 2  # of one diagnosis (workflow/rules/diagnosis.smk)
OTHERS = {"laboratory": 20.0, "figures": 6.0, "report": 3.0, "tracking": 8.0}  # s, of the jobs of these rules
COMPILING = 90.0  # s, the first time that palpate runs on a machine


def expected(study: Study, cores: int) -> Iterator[str]:
    """Yield the time that a study is expected to take on so many cores, and its parts."""
    jobs, cost, sets = job_seconds(study), _cost_of_curve(study), study.recordings
    groups = len(conditions_by_shape(study))
    mechanisms = len(candidates(study)) if study.diagnosis.enabled and sets else 0
    threads = min(cores, DIAGNOSIS_THREADS)
    calibrations = [
        _calibration(study, cost, name, len(each)) for name in sets for each in study.condition_sets.values()
    ]
    diagnoses = [_diagnosis(study, cost, name) / threads for name in sets] if mechanisms else []
    choice = jobs["choose_law"]
    snapshots = _clock([jobs["snapshots"]] * (groups * _batches(study, groups)), cores)
    laboratories = jobs["laboratory"] * len(study.laboratory) / cores
    surrogates = _clock([jobs["surrogate"]] * len(study.calibrated), cores)
    fits, explanations = _clock(calibrations, cores), _clock(diagnoses, cores // threads)
    searches = len(sets) * (len(study.condition_sets) + (mechanisms > 0))
    pyramids = searches * PYRAMIDS * sum(not study.tip_of(each).of_revolution for each in study.conditions)
    accurate = cost * PYRAMID * pyramids
    others = PLANNING + START * (1 + len(sets)) + jobs["figures"] + jobs["report"] + jobs["tracking"]
    total = choice + snapshots + laboratories + surrogates + fits + explanations + accurate + others
    parts = [f"choice of the law {time_in_words(choice)}"] if choice else []
    parts += [f"{len(study.cells) * groups} snapshots {time_in_words(snapshots)}"]
    parts += [f"calibration {time_in_words(fits)}"] if sets else []
    parts += [f"diagnosis of {mechanisms} mechanisms {time_in_words(explanations)}"] if mechanisms else []
    parts += [f"up to {pyramids} curves of the pyramid {time_in_words(accurate)}"] if pyramids else []
    parts += [f"surrogates, figures, report and starts of jobs {time_in_words(laboratories + surrogates + others)}"]
    processors = f"{cores} free core{'s' if cores > 1 else ''}"
    finer = "" if study.accuracy == STANDARD else f" for accuracy {STANDARD} ({study.accuracy} takes longer)"
    yield (
        f"expected time, within a factor of two{finer}: {time_in_words(total)} on {processors} ({', '.join(parts)}); "
        f"{time_in_words(COMPILING)} more at the first use, for compilation"
    )


def job_seconds(study: Study) -> dict[str, float]:
    """Return the time that a job of each rule is expected to take on a free core [s], by the beginning of its name."""
    cost, groups = _cost_of_curve(study), len(conditions_by_shape(study))
    conditions = len(study.calibrated)
    return {
        "choose_law": _choice(study, cost),
        "snapshots": START + cost * len(study.cells) / _batches(study, groups),
        "surrogate": SURROGATE,
        "calibration": max((_calibration(study, cost, name, conditions) for name in study.recordings), default=0.0),
        "diagnosis": max((_diagnosis(study, cost, name) for name in study.recordings), default=0.0),
        "main_calibration": START,
        "snapshot_index": START,
        **OTHERS,
    }


def _batches(study: Study, groups: int) -> int:
    """Return how many jobs simulate the snapshots of one of so many groups of conditions."""
    return math.ceil(len(study.cells) / cells_of_a_job(study, groups))


def _clock(jobs: Sequence[float], cores: int) -> float:
    """Return the time until independent jobs have ended on so many cores [s]: no less than the longest takes."""
    return max(max(jobs, default=0.0), sum(jobs) / cores)


def _together(cost: float, conditions: int) -> float:
    """Return the time of one curve of each condition [s], as conditions are solved together."""
    return cost * (1.0 + FURTHER * (conditions - 1))


def _choice(study: Study, cost: float) -> float:
    """Return the time until the law is chosen [s], none where it is known."""
    if not study.law_is_open:
        return 0.0
    curves = CHOICE + OTHER_LAW * len(FAMILIES[study.family].others)
    return START + curves * _together(cost, len(study.calibrated))


def _calibration(study: Study, cost: float, recordings: str, conditions: int) -> float:
    """Return the time of the calibration of a set of recordings on so many conditions [s]."""
    curves = CALIBRATION if _replicated(study, recordings) else CALIBRATION_ALONE
    return START + curves * _together(cost, conditions)


def _replicated(study: Study, recordings: str) -> bool:
    """Return whether a set of recordings has about two or more tests of each condition."""
    return len(files_of(study, recordings)) >= 2 * len(study.tested)


def _diagnosis(study: Study, cost: float, recordings: str) -> float:
    """Return the time of the diagnosis of a set of recordings [s]."""
    imprint = _is_elastic(study) and any(map(_left_imprint, files_of(study, recordings)[:1]))
    each = ALONE if not _replicated(study, recordings) else UNSUITED if imprint else EXPLANATION
    names = [{parameter.name for parameter in mechanism.parameters} for mechanism in candidates(study).values()]
    explained = sum(_cost_of_curve(study, YIELDS in added) for added in names)
    curves = DIAGNOSIS * cost + each * explained
    return START + _together(curves, len(study.calibrated))


def _left_imprint(file: Path) -> bool:
    """Return whether a test ends deeper than an elastic cone's would at its last load; not where it is to be made yet.

    That depth, a share sqrt(P / P_max) of the largest, is above those of blunter tips.
    """
    if not file.is_file():
        return False
    test = read_recording(file)
    elastic = np.sqrt(max(test.load[-1], 0.0) / test.load.max())
    return bool(test.depth[-1] / test.depth.max() > elastic + IMPRINT)


def _is_elastic(study: Study) -> bool:
    """Return whether a study's law has no parameters but those of elasticity."""
    return len(study.declared) <= 2 and not study.law_is_open


def _cost_of_curve(study: Study, yields: bool = False) -> float:
    """Return the processor time of one curve of a study [s], with a mechanism by which the body `yields`."""
    yields = yields or YIELDS in study.declared or (study.law_is_open and study.family != GEL)
    cost = PLASTIC if yields else ELASTIC if _is_elastic(study) else CREEP
    corners = max(len(condition.protocol.knot_time) for condition in study.conditions) - 4
    return cost * study.points / 100 * (1.0 + CORNERS * max(corners, 0))


def time_in_words(seconds: float) -> str:
    """Return a time with one digit, in seconds, minutes or hours."""
    if seconds < 90.0:
        return f"{max(float(f'{seconds:.1g}'), 1.0):.0f} s"
    if seconds < 3600.0:
        return f"{float(f'{seconds / 60.0:.1g}') if seconds < 600.0 else round(seconds / 60.0, -1):.0f} min"
    return f"{seconds / 3600.0:.1f} h"
