"""A study that leaves its law to recordings, in the workflow: what is planned before and after the choice."""

import json

import numpy as np
import pytest
from tiny_study import TINY, copied, planned, snakemake

from indentation_files.recording import Recording

CONDITION = {"name": "T030", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}
OPEN = {key: TINY[key] for key in ("study", "indenter", "points", "cells_per_job")} | {
    "material": {"model": "auto", "family": "metal", "poisson_ratio": 0.3},
    "design": {"kind": "sobol", "points": 16},
    "conditions": [CONDITION],
    "recordings": {"lab": "recordings"},
    "diagnosis": {"mechanisms": ["thermal_drift", "plastic_yield"], "bootstrap": 400},
}
AFTER = {"snapshot_index", "surrogate", "calibration_on_all", "main_calibration", "diagnosis", "report", "tracking"}


@pytest.fixture
def folder(tmp_path):
    """A folder with the workflow, and a test that is unloaded elastically to half of its depth."""
    time = np.linspace(0.0, 60.0, 121)
    load = 1.0 - np.abs(1.0 - time / 30.0)
    depth = 200.0 * np.where(time <= 30.0, np.sqrt(load), 0.5 + 0.5 * load)
    (tmp_path / "recordings").mkdir()
    Recording(time, load, depth, "made").write(tmp_path / "recordings/T030_1.csv")
    return copied(tmp_path)


def test_the_choice_comes_first_and_what_follows_is_planned_when_it_is_made(folder):
    assert planned(folder, study=OPEN) == {"choose_law", "figures", "all"} | AFTER


def test_tests_without_unloading_are_refused_before_a_job_begins(folder):
    file = folder / "recordings/T030_1.csv"
    lines = file.read_text().splitlines()
    file.write_text("\n".join(lines[: len(lines) // 2]) + "\n")
    study = OPEN | {"conditions": [CONDITION | {"load_history": "recorded"}]}
    for key in ("max_load", "loading_time", "unloading_time"):
        del study["conditions"][0][key]
    run = snakemake(folder, "--dry-run", study=study)
    assert run.returncode == 2
    assert "no test is unloaded, so that the laws of the family metal cannot be told from each other" in run.stderr


def test_report_and_record_of_a_choice_name_all_laws(folder, monkeypatch):
    from palpate.configuration.study_file import study_from
    from palpate.output.results.law_candidates import choice_sentences, choice_table
    from palpate.workflow_support.runs_of_results import of_choice, of_study

    monkeypatch.chdir(folder)
    parameters = {"youngs_modulus": {"estimate": 70.0, "lower": 65.0, "upper": 75.0}}
    first = {"law": "ludwik_plasticity", "probability": 0.7, "log_evidence": 12.0, "residual_nm": 1.0}
    first |= {"residual_percent": 0.2, "held_out_nm": None, "curves": 40, "parameters": parameters}
    second = first | {"law": "bilinear_plasticity", "probability": 0.3, "log_evidence": 11.2}
    choice = {
        "family": "metal",
        "recordings": "lab",
        "law": first["law"],
        "levels": {
            "youngs_modulus": [65.0, 75.0],
            "yield_stress": [0.1],
            "strength": [0.5],
            "hardening_exponent": [0.3],
        },
        "probability": 0.7,
        "runner_up": second,
        "curves": 80,
        "candidates": [first, second],
    }
    file = folder / "results/tiny/law.json"
    file.parent.mkdir(parents=True)
    file.write_text(json.dumps(choice))
    study = study_from(OPEN, "study.yaml")
    assert (study.model, study.choice) == ("ludwik_plasticity", choice)
    assert choice_sentences(choice).endswith("With 30 % it is bilinear plasticity: Young's modulus 70 (65 to 75) GPa.")
    assert list(choice_table(choice)["law"]) == ["Ludwik plasticity", "bilinear plasticity"]
    run = of_choice(study, choice, file)
    assert run.metrics["law_probability"] == 0.7 and "bilinear" in run.tables["candidates.csv"]
    assert of_study(study)["runner_up"] == run.params["runner_up"] == "bilinear plasticity, 0.3"
