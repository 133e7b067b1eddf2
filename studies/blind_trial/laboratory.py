"""The trial's virtual laboratory: finer mesh and time steps than the tool's, noise with memory, scatter, slow drift."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from indentation_files.recording import SYNTHETIC, Recording
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.laboratory.virtual import correlated_noise, off_the_mesh
from palpate.mechanisms import MECHANISMS
from palpate.solver.variation import written
from studies.blind_trial.cases import Case
from studies.blind_trial.unknown import UNKNOWN, Curve

REPLICATES = 3


def body_depths(
    study: Study, cases: Sequence[Case], conditions: Sequence[Condition], accuracy: str
) -> list[list[np.ndarray]]:
    """Simulate what acts on the bodies themselves, without what varies between recordings; all of it together.

    Returns
    -------
    depths
        For each of the conditions those of each of the cases [nm].

    Raises
    ------
    PalpateError
        When a simulation fails.
    """
    wanted = list(itertools.product(conditions, cases))
    specifications = []
    for condition, case in wanted:
        acting = {k: v for k, v in case.mechanisms.items() if not (MECHANISMS[k].varies or MECHANISMS[k].by_test_order)}
        specification = study.specification(case.parameters, condition, accuracy)
        specifications.append(replace(specification, mechanisms=acting))
    outcomes = off_the_mesh(specifications, [f"{case.name}, {condition.name}" for condition, case in wanted])
    depths = iter([outcome.depth for outcome in outcomes])
    return [list(itertools.islice(depths, len(cases))) for _ in conditions]


def record(
    case: Case, condition: Condition, depth: np.ndarray, rng: np.random.Generator, before: int = 0
) -> list[Recording]:
    """Return the recordings of one condition, made after some `before`, where the body is indented by `depth` (n,)."""
    protocol, noise = condition.protocol, case.noise
    time, load = protocol.sample_time, protocol.sample_load
    if case.unknown:
        test = Curve(time, load, depth, protocol)
        depth = UNKNOWN[case.unknown["key"]](test, case.unknown["strength"], rng)
    recordings = []
    for replicate in range(1, REPLICATES + 1):
        h = depth * (1.0 + noise["site_scatter"] * rng.standard_normal())
        for key, values in case.mechanisms.items():
            mechanism = MECHANISMS[key]
            if mechanism.by_test_order:
                h = written({key: values}, time, load, h, order=before + replicate)
            if mechanism.varies:
                own = {name: 1.0 + noise["own"] * rng.standard_normal() for name in mechanism.amplitudes}
                h = mechanism.record(time, load, h, {name: v * own.get(name, 1.0) for name, v in values.items()})
        h = h + noise["sigma_nm"] * first_order(len(time), noise["memory"], rng)
        h = h + background(time, noise["drift_nm_s"], noise["drift_time_s"], rng)
        notes = (f"{SYNTHETIC}: written by palpate's blind trial, not measured", f"test_number: {before + replicate}")
        recordings.append(Recording(time, load, h, name=f"{condition.name}_{replicate}", notes=notes))
    return recordings


def write(study: Study, cases: Sequence[Case], folder: Path) -> None:
    """Write the recordings of some cases, each into a folder of its own."""
    generators = [np.random.default_rng(case.seed) for case in cases]
    depths = body_depths(study, cases, study.conditions, study.challenge.accuracy)
    for number, (condition, of_cases) in enumerate(zip(study.conditions, depths, strict=True)):
        for case, depth, rng in zip(cases, of_cases, generators, strict=True):
            (folder / case.name).mkdir(parents=True, exist_ok=True)
            for recording in record(case, condition, depth, rng, before=number * REPLICATES):
                recording.write(folder / case.name / f"{recording.name}.csv")


def first_order(points: int, memory: float, rng: np.random.Generator) -> np.ndarray:
    """Return stationary autoregressive noise (points,) of unit variance."""
    return correlated_noise(np.arange(points), 1.0, -1.0 / np.log(memory), rng)


def background(time: np.ndarray, rate: float, memory: float, rng: np.random.Generator) -> np.ndarray:
    """Return the depth (n,) [nm] that a slowly varying drift adds at times (n,) [s].

    Its rate is stationary, with the standard deviation `rate` [nm/s] and the correlation time `memory` [s].
    """
    drift = correlated_noise(np.append(0.0, time), rate, memory, rng)[1:]
    return np.cumsum(drift * np.diff(time, prepend=0.0))
