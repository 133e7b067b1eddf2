"""The runs of surrogates, calibrations, diagnoses and sets of recordings, as `run_records` writes them to disk."""

from __future__ import annotations

import datetime
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from palpate.configuration.study_file import Study
from palpate.materials import law_of
from palpate.mechanisms import MECHANISMS
from palpate.output.results.answer import Answer
from palpate.output.results.bulk_errors import bulk_metrics
from palpate.output.results.calibration import Calibration
from palpate.output.results.imprint_errors import imprint_metrics
from palpate.output.saved_set import SavedSet, labels
from palpate.output.tip_words import tips_in_words
from palpate.surrogate import PODRBF
from palpate.workflow_support.result_files import checksum
from palpate.workflow_support.run_records import (
    ANSWERS,
    ROLES,
    Record,
    Run,
    began,
    calibration_metrics,
    errors_of_base,
    now,
)

DIGITS = 5  # of numbers that people compare; those that are rounded again differ from the report once in a hundred


def of_choice(study: Study, choice: Mapping[str, Any], file: str | Path) -> Run:
    """Return the run of the choice of the law: every law that was compared, and what it took."""
    title = law_of(choice["law"]).title
    best = choice["candidates"][0]
    names = ("probability", "log_evidence", "residual_nm", "residual_percent", "held_out_nm")
    metrics = {name: float(best[name]) for name in names if best[name] is not None}
    compared = pd.DataFrame(choice["candidates"]).drop(columns="parameters")
    return Run(
        f"choice of the law - {title}",
        "law",
        {"recordings": choice["recordings"]},
        {"law": title, "family": study.family, "runner_up": runner_up(choice), "seed": study.seed},
        metrics | {"law_probability": metrics.pop("probability"), "curves": float(choice["curves"])},
        files=[str(file)],
        tables={"candidates.csv": compared.to_csv(index=False)},
    )


def runner_up(choice: Mapping[str, Any]) -> str:
    """Return the law that comes second and its probability, in words."""
    second = choice["runner_up"]
    return f"{law_of(second['law']).title}, {second['probability']:.2g}" if second else "none"


def of_surrogate(study: Study, condition: str, model: PODRBF, summary: Mapping[str, Any]) -> Run:
    """Return the run of the surrogate of a condition: the settings of study and model, and the summary of its fit."""
    unit = summary["unit"]
    kernel = model.get_params()["kernel"]
    metrics = {name: float(value) for name, value in summary.items() if isinstance(value, int | float)}
    metrics[f"surrogate_{unit}"] = metrics.pop(f"loo_rmse_{unit}")
    ranges = {f"levels.{name}": ", ".join(f"{level:g}" for level in row) for name, row in study.levels.items()}
    return Run(
        f"surrogate {labels(study)[condition]} - {kernel}",
        "surrogate",
        {"condition": condition},
        of_study(study) | dict(model.get_params()) | ranges,
        metrics,
        {f"by_point.loo_rms_{unit}": summary[f"loo_rms_{unit}"]},
        model=f"surrogate {condition} {kernel}",
        inputs=list(study.levels),
    )


def of_calibration(saved: SavedSet, condition_set: str, files: Sequence[str | Path]) -> Run:
    """Return the run of the calibration of one condition set: estimates, errors, misfit, convergence."""
    found = Calibration(saved, condition_set)
    search = "; ".join(f"{key} {value}" for key, value in saved.study.calibration)
    return Run(
        f"calibration of {saved.name} on {condition_set} - {saved.study.surrogate.kernel}",
        "calibration",
        {"recordings": saved.name, "condition_set": condition_set},
        of_study(saved.study) | {"search": search},
        calibration_metrics(found.content) | _worst(saved),
        {"by_generation.best_sum": [row["best_sum"] for row in found.content["history"]]},
        list(map(str, files)),
        {"errors_by_condition.csv": found.errors.to_csv(index=False)},
    )


def of_diagnosis(content: Mapping[str, Any], study: Study, files: Sequence[str | Path]) -> list[Run]:
    """Return the run of a diagnosis, and one for every explanation that was fitted."""
    of, name = {"recordings": content["recordings"]}, content["recordings"]
    tags = of | _verdict(content) | {"mlflow.note.content": content["sentence"]}
    settings = "; ".join(f"{key} {value}" for key, value in study.diagnosis.model_dump(exclude_none=True).items())
    params = of_study(study)
    title, metrics = f"diagnosis of {name} - {content['verdict']}", _of_diagnosis(content)
    whole = Run(title, "diagnosis", tags, params | {"settings": settings}, metrics)
    whole.files = list(map(str, files))
    accepted = {tuple(each["mechanisms"]): each["parameters"] for each in content["candidates"]}
    for members in list(accepted)[:1]:
        accepted[members] = content["parameters"]["after"] | accepted[members]
    explanations = []
    for row in content["tried"]:
        title = " + ".join(MECHANISMS[key].title for key in row["mechanisms"]) or "base model"
        found = {"fitted_nm": row["rmse_nm"], "log_evidence": row["log_evidence"], "probability": row["probability"]}
        found |= row["parameters"] | row["material"]
        found |= {key: each["estimate"] for key, each in accepted.get(tuple(row["mechanisms"]), {}).items()}
        found = {key: float(f"{value:.{DIGITS}g}") for key, value in found.items()}
        tags = {**of, "mechanisms": "+".join(row["mechanisms"]) or "none"}
        explanations.append(Run(f"{title} - explanation", "explanation", tags, params, found))
    return [whole, *explanations]


def of_sets(record: Record, sets: Sequence[SavedSet], folder: Path) -> None:
    """Add the run of each set of recordings, and what the execution's own run repeats of them.

    Parameters
    ----------
    folder
        Of the study's results, with report and figures.
    """
    record.runs += [_of_set(Answer(saved), folder) for saved in sets]
    if len(record.runs) == 1:
        (run,) = record.runs
        record.parent = {key: getattr(run, key) for key in ("name", "tags", "params", "metrics")}
    elif record.runs:
        counts = Counter(run.tags["verdict"] for run in record.runs)
        verdicts = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
        name = f"{len(sets)} sets: {verdicts} - {sets[0].study.surrogate.kernel} - {_clock()}"
        record.parent = {"name": name, "tags": {"verdict": verdicts}, "params": of_study(sets[0].study), "metrics": {}}


def _of_set(found: Answer, folder: Path) -> Run:
    """Return the run of one set of recordings, with plain keys."""
    saved, study = found.saved, found.saved.study
    content: Mapping[str, Any] = saved.diagnosis or {"verdict": "not diagnosed", "mechanisms": []}
    metrics = {entry["name"]: entry["estimate"] for entry in found.parameters}
    metrics |= {effect["name"]: effect["estimate"] for effect in found.effects}
    metrics |= _of_diagnosis(content) if saved.diagnosis else errors_of_base(found.calibration.content)
    metrics |= {"law_probability": study.choice["probability"]} if study.choice else {}
    metrics |= {"chi2_per_dof": found.calibration.content["misfit_ratio"]} | _worst(saved)
    if saved.accepted:
        metrics |= {"probability": saved.accepted[0]["probability"], "log_evidence": saved.accepted[0]["log_evidence"]}
    metrics |= bulk_metrics(found.calibration.uniaxial) | imprint_metrics(found.calibration.imprint)
    if found.discrepancy:
        metrics["discrepancy"] = found.discrepancy["share"]
    with_set = f"{saved.name}: " if len(study.recordings) > 1 else ""
    name = f"{with_set}{found.headline[0].lower()}{found.headline[1:]} - {study.surrogate.kernel} - {_clock()}"
    tags = {"recordings": saved.name} | _verdict(content) | {"mlflow.note.content": found.sentence}
    shown = {key: float(f"{value:.{DIGITS}g}") for key, value in metrics.items()}
    run = Run(name, ANSWERS, tags, of_study(study) | {"recordings": saved.name}, shown)
    figures = sorted((folder / "figures").glob(f"{saved.name}_*.svg")) + sorted(
        (folder / "figures").glob("surrogates.svg")
    )
    run.files = [str(file) for file in (folder / "report.html", folder / "report.json", *figures) if file.is_file()]
    run.dataset = _dataset(saved)
    if (start := began()) is not None:
        run.started = start
        run.metrics["seconds"] = round((now() - start) / 1000.0)
    return run


def _dataset(saved: SavedSet) -> dict[str, str]:
    """Return name, digest and folder of the recordings of a set."""
    folder = saved.study.recordings[saved.name]
    sums = "".join(checksum(file) for file in sorted(Path(folder).glob("*.csv")))
    return {"name": saved.name, "digest": f"{zlib.crc32(sums.encode()):08x}", "source": str(folder)}


def of_study(study: Study) -> dict[str, Any]:
    """Return by what studies are compared: law, tip, kernel, design, seed; of a chosen law its runner-up."""
    chosen = {"family": study.family, "runner_up": runner_up(study.choice)} if study.choice else {}
    return chosen | {
        "law": law_of(study.model).title,
        "kernel": study.surrogate.kernel,
        "shape": study.surrogate.shape,
        "tip": tips_in_words(study),
        "design": f"{study.design.kind}, {len(study.cells)} materials",
        "kinematics": study.kinematics,
        "seed": study.seed,
    }


def _worst(saved: SavedSet) -> dict[str, float]:
    """Return the largest error of the surrogates, by unit."""
    found: dict[str, float] = {}
    for summary in saved.surrogates.values():
        key = f"surrogate_{summary['unit']}"
        found[key] = max(found.get(key, 0.0), summary[f"loo_rmse_{summary['unit']}"])
    return found


def _verdict(content: Mapping[str, Any]) -> dict[str, str]:
    """Return verdict and identified effects, and whether the law lies within the tolerance, where that is known."""
    within = {key: str(content[key]).lower() for key in ("law_within_tolerance",) if key in content}
    return {"verdict": content["verdict"], "mechanisms": "+".join(content["mechanisms"]) or "none"} | within


def _of_diagnosis(content: Mapping[str, Any]) -> dict[str, float]:
    """Return what a diagnosis states in numbers: p-value, errors, probabilities and the discrepancy."""
    found = {"p_value": content["p_value"]} | _errors(content)
    for key, entry in (("nothing_further", "probability"), ("discrepancy", "share")):
        if content.get(key):
            found[key] = content[key][entry]
    for key in ("inclusion", "family_inclusion"):
        found |= {f"{key}.{name}": probability for name, probability in content.get(key, {}).items()}
    return found


def _errors(content: Mapping[str, Any]) -> dict[str, float]:
    """Return the errors of a diagnosis by role, before and after, where there are any, and the noise."""
    errors = {}
    for role, name in ROLES.items():
        for when, key in (("before", f"before_{name}_nm"), ("after", f"{name}_nm")):
            if (value := content["fit"][role][f"{when}_rmse_nm"]) is not None:
                errors[key] = value
    return errors | {"noise_nm": content["fit"]["noise_nm"]}


def _clock() -> str:
    """Return the hour and minute at which the execution began, or now."""
    start = began() or now()
    return datetime.datetime.fromtimestamp(start / 1000).strftime("%H:%M")
