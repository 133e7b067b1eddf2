"""A study: what is simulated, what was recorded, and how the two are compared. Read from one YAML file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from indentation_files.readers import VendorTest, read_source
from palpate.base.parameters import Parameter
from palpate.base.yaml_file import read_yaml
from palpate.configuration.checked_file import check_contradictions, checked_file
from palpate.configuration.chosen_law import with_chosen_law
from palpate.configuration.condition import Condition, condition_sets_of, conditions_of_entry
from palpate.configuration.further_evidence import EvidenceFile, evidence_from
from palpate.configuration.instrument_section import Instrument, instrument_from
from palpate.configuration.levels import checked_levels
from palpate.configuration.prescribed_history import Histories
from palpate.configuration.recording_sets import recording_sets
from palpate.configuration.settings import (
    CalibrationSettings,
    Challenge,
    Design,
    DiagnosisSettings,
    LaboratorySettings,
    SurrogateSettings,
)
from palpate.configuration.source_section import source_from
from palpate.configuration.tips import check_tips, indenters_of
from palpate.design.sampling import factorial, sobol
from palpate.errors import InputError, located_in, part_of
from palpate.materials import law_of
from palpate.mechanisms import checked_mechanisms, known
from palpate.study.indenter import Indenter
from palpate.study.specification import Specification

SHARED = (  # names in results that belong to no study
    "mlartifacts", "mlflow.db", "mlflow.db-journal", "mlflow.db-shm", "mlflow.db-wal", "mlflow.db.lock", "store",
    "thesis", "verification",
)  # fmt: skip
TAKEN_AS_THEY_ARE = (
    "accuracy", "calibration", "cells_per_job", "challenge", "design", "diagnosis", "kinematics", "laboratory",
    "points", "seed", "surrogate",
)  # fmt: skip


@dataclass(frozen=True)
class Study:
    """A checked study; docs/study.md describes each key.

    Attributes
    ----------
    name, title, file
        Name, title for people, and the YAML file.
    model
        Key of the constitutive law.
    family, choice
        Family of the material where recordings choose the law, and the content of `palpate.choice.choose.Choice` once
        they have; before, the law is linear elasticity. Both are empty where the study states a law.
    fixed
        Material parameters that are not on the grid.
    levels
        Levels of the snapshot grid for each parameter, in order; one level holds a parameter constant.
    design
        How the snapshots lie: `kind` ``factorial`` takes every combination of the levels, ``sobol`` as many `points` of
        a Sobol sequence between the lowest and the highest ones.
    indenter, kinematics, accuracy, points
        How a snapshot is simulated; the indenter is the tip of conditions that name none.
    tips
        Tips that conditions name, by their names.
    conditions
        All loading conditions; the parts of one that are held out follow it as a condition ``NAME.held_out``.
    condition_sets
        Names of the conditions that each calibration uses; ``all`` is always there.
    recordings, evidence, instrument
        Folder of each set of recordings, what was measured of the material besides indentation, and shared effects.
    cells_per_job, seed, surrogate, calibration, diagnosis, challenge, laboratory
        Settings with their defaults filled in.
    source
        The vendor's file that a set of recordings is converted from, see `indentation_files.readers.read_source`; empty
        without one.
    source_tests
        Reads the tests of each condition from the vendor's file of `source`, once.
    """

    name: str
    title: str
    file: Path
    model: str
    family: str
    choice: Mapping[str, Any]
    fixed: Mapping[str, float]
    levels: Mapping[str, tuple[float, ...]]
    design: Design
    indenter: Indenter
    tips: Mapping[str, Indenter]
    kinematics: str
    accuracy: str
    points: int
    conditions: tuple[Condition, ...]
    condition_sets: Mapping[str, tuple[str, ...]]
    recordings: Mapping[str, Path]
    evidence: tuple[EvidenceFile, ...]
    cells_per_job: int | None
    seed: int
    surrogate: SurrogateSettings
    calibration: CalibrationSettings
    diagnosis: DiagnosisSettings
    challenge: Challenge
    laboratory: Mapping[str, LaboratorySettings]
    instrument: Instrument | None
    source: Mapping[str, Any]
    source_tests: Callable[[], Mapping[str, list[VendorTest]]] = field(compare=False, repr=False)

    @property
    def law_is_open(self) -> bool:
        """Whether recordings choose the law, and have not yet."""
        return bool(self.family) and not self.choice

    @property
    def free_parameters(self) -> tuple[str, ...]:
        """Parameters with more than one level: those that a calibration looks for."""
        return tuple(name for name, levels in self.levels.items() if len(levels) > 1)

    @property
    def declared(self) -> dict[str, Parameter]:
        """What the law declares of each parameter by name, such as symbol and unit."""
        return {p.name: p for p in law_of(self.model).declared({**self.fixed, **self.levels})}

    @property
    def cells(self) -> list[dict[str, float]]:
        """Material parameters of the snapshots."""
        if self.design.kind == "factorial":
            return factorial(self.levels)
        constant = {name: levels[0] for name, levels in self.levels.items()}
        bounds = {name: (min(self.levels[name]), max(self.levels[name])) for name in self.free_parameters}
        return [{**constant, **point} for point in sobol(bounds, self.design.points, self.seed)]

    @property
    def calibrated(self) -> list[Condition]:
        """Conditions with the role ``calibrate``."""
        return [condition for condition in self.conditions if condition.role == "calibrate"]

    @property
    def tested(self) -> dict[str, Condition]:
        """Conditions of which there are recordings, by name, each sampled over the whole test."""
        samples: dict[str, list[np.ndarray]] = {}
        for each in self.conditions:
            samples.setdefault(each.test, []).append(each.protocol.sample_time)
        whole = {name: np.sort(np.concatenate(times)) for name, times in samples.items()}
        return {
            each.name: replace(each, protocol=replace(each.protocol, sample_time=whole[each.name]))
            for each in self.conditions
            if not each.part_of
        }

    def condition(self, name: str) -> Condition:
        """Return the condition called `name`."""
        return next(condition for condition in self.conditions if condition.name == name)

    def tip_of(self, condition: Condition) -> Indenter:
        """Return what presses under a condition."""
        return self.tips[condition.tip] if condition.tip else self.indenter

    @property
    def of_revolution(self) -> bool:
        """Whether none of its tips is a pyramid."""
        return all(tip.of_revolution for tip in (self.indenter, *self.tips.values()))

    def by_tip(self, conditions: Iterable[Condition]) -> dict[str, list[Condition]]:
        """Return conditions by the names of their tips; that of the study's own tip is empty."""
        found: dict[str, list[Condition]] = {}
        for condition in conditions:
            found.setdefault(condition.tip, []).append(condition)
        return found

    def specification(
        self, cell: Mapping[str, float], condition: Condition, accuracy: str | None = None
    ) -> Specification:
        """Return what to simulate for material parameters `cell` under `condition`."""
        return Specification(
            self.model,
            {**self.fixed, **cell},
            self.tip_of(condition),
            condition.protocol,
            kinematics=self.kinematics,
            accuracy=accuracy or self.accuracy,
            tip=condition.tip,
        )


def load_study(path: str | Path, data: str | None = None) -> Study:
    """Read and check a study.

    Parameters
    ----------
    path
        The YAML file.
    data
        The vendor's file in place of the one that ``source`` names, or a folder that holds one of that name.

    Raises
    ------
    InputError
        With file, place and remedy, on anything misspelt, missing, contradictory or unphysical.
    """
    return study_from(read_yaml(path), path, data)


def study_from(values: Any, file: str | Path, data: str | None = None) -> Study:
    """Check a study that was read.

    Parameters
    ----------
    values
        What a YAML file holds.
    file
        Where it was read, for messages.
    data
        As for `load_study`.

    Raises
    ------
    InputError
        As `load_study`.
    """
    with located_in(file):
        return _study(values, Path(file), data)


def _study(values: Any, path: Path, data: str | None) -> Study:
    given = checked_file(values)
    if given.study in SHARED:
        raise InputError(f"{given.study!r} is reserved for other results", remedy="choose another name", place="study")
    given, family, choice = with_chosen_law(given)
    known(given.diagnosis.mechanisms, "diagnosis.mechanisms")
    known(given.challenge.mechanisms, "challenge.mechanisms")
    check_contradictions(given)
    material = given.material.model_dump(exclude_none=True)
    with part_of("material"):
        model = law_of(material.pop("model")).key
    source = source_from(given, data if data is not None else given.data)
    tests = cache(lambda: read_source(source))
    levels = checked_levels(model, material, given.parameters or {}, given.design.kind)
    indenter, tips = indenters_of(given)
    check_tips(given, tips)
    recordings = recording_sets(given)
    measured = {name: folder for name, folder in recordings.items() if name not in given.laboratory}
    histories = Histories(given.points, measured, source, tests)
    least = 1 + sum(len(each) > 1 for each in levels.values())
    entries = enumerate(each.model_dump(exclude_unset=True, exclude_none=True) for each in given.conditions)
    conditions = tuple(each for k, entry in entries for each in conditions_of_entry(k, entry, histories, least))
    names = [condition.name for condition in conditions]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"condition {name!r} is given twice", remedy="rename one of them", place="conditions")
    study = Study(
        name=given.study,
        title=given.title or given.study,
        file=path,
        model=model,
        family=family,
        choice=choice,
        fixed=material,
        levels=levels,
        indenter=indenter,
        tips=tips,
        conditions=conditions,
        condition_sets=condition_sets_of(given.condition_sets, conditions),
        recordings=recordings,
        evidence=evidence_from(given.evidence, names),
        instrument=instrument_from(given),
        source=source,
        source_tests=tests,
        **{key: getattr(given, key) for key in TAKEN_AS_THEY_ARE},
    )
    study.specification(study.cells[0], conditions[0])
    _check_laboratories(study)
    return study


def _check_laboratories(study: Study) -> None:
    for key, settings in study.laboratory.items():
        place = f"laboratory.{key}"
        with part_of(f"{place}.parameters"):
            for name in settings.parameters:
                if name in study.fixed:
                    raise InputError(
                        f"is {study.fixed[name]:g} under material",
                        remedy="take it out here, or give it levels under parameters",
                        place=name,
                    )
            study.specification(settings.parameters, study.conditions[0])
        with part_of(place):
            checked_mechanisms(settings.mechanisms)
