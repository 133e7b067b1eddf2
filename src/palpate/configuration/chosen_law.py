"""``material: {model: auto, family: ..}``: the law of a study that its recordings choose.

The choice is a result of the study, ``results/STUDY/law.json`` (`palpate.choice.choose`). Once it is there, the study
is read with the law and the ranges that it names. Before, it is read with linear elasticity: all that does not depend
on the law, such as conditions and recordings, is checked and planned.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.configuration.settings import Design
from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError
from palpate.materials import ELASTIC
from palpate.materials.families import FAMILIES

AUTO, FAMILY = "auto", "family"
WIDEST = [1e-9, 1200.0]  # GPa, from the softest gel to diamond: the modulus before a law is chosen
POINTS = 128  # materials of a study whose grid is not stated


def choice_file(study: str) -> Path:
    """Return the file of the choice that a study of this name makes."""
    return Path("results", study, "law.json")


def with_law(study: StudyFile, law: str, levels: Mapping[str, Any]) -> StudyFile:
    """Return a study's file with a law and levels of its parameters in place of the choice."""
    material = study.material.model_copy(update={"model": law, FAMILY: None})
    stated = "design" in study.model_fields_set
    design = study.design if stated else Design(kind="sobol", points=POINTS)
    return study.model_copy(update={"material": material, "parameters": dict(levels), "design": design})


def with_chosen_law(study: StudyFile) -> tuple[StudyFile, str, dict[str, Any]]:
    """Return a study's file with its law, its family and what was chosen; both are empty where it states a law.

    Raises
    ------
    InputError
        When the keys of a chosen law and of a stated one are mixed, or nothing can choose.
    """
    material, family = study.material, study.material.family or ""
    if material.model != AUTO:
        if family:
            remedy = "leave the family out, or write model: auto"
            raise InputError("a family has no effect beside a stated law", remedy=remedy, place="material.family")
        if study.parameters is None:
            remedy = "give levels of the law's parameters; only with model: auto they may be left out"
            raise InputError("the key 'parameters' is missing", remedy=remedy, place="top level")
        return study, "", {}
    _check(study)
    if found := _made(choice_file(study.study), family):
        return with_law(study, found["law"], found["levels"]), family, found
    return with_law(study, ELASTIC.key, {"youngs_modulus": WIDEST}), family, {}


def _check(study: StudyFile) -> None:
    """Refuse keys with which no law can be chosen; raises `InputError`."""
    material, place = study.material.model_dump(exclude_none=True), "material"
    if FAMILY not in material:
        problem, remedy = "model: auto needs the family of the material", f"add family: {', '.join(FAMILIES)}"
    elif further := [key for key in material if key not in ("model", FAMILY, "poisson_ratio")]:
        problem, remedy = f"{further[0]!r} belongs to a law, and none is chosen yet", "leave it out, or state the law"
        place = f"material.{further[0]}"
    elif study.parameters is not None:
        problem, remedy, place = "parameters belong to a law, and none is chosen yet", "leave them out", "parameters"
    elif not study.recordings:
        problem, remedy = "recordings choose a law, and the study has none", "name their folder, or state the law"
    elif study.laboratory:
        problem, remedy = "a virtual laboratory needs a law that is stated", "name one in place of auto"
    else:
        return
    raise InputError(problem, remedy=remedy, place=place)


def _made(file: Path, family: str) -> dict[str, Any]:
    """Return the choice that a file holds; nothing where it is missing, of another family, or damaged."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) and found.get(FAMILY) == family else {}


def best_parameters(choice: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters with which the chosen law fits the recordings best, by name."""
    (chosen,) = (row for row in choice["candidates"] if row["law"] == choice["law"])
    return {name: float(found["estimate"]) for name, found in chosen["parameters"].items()}
