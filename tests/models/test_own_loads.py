"""Tests of one method under unlike loads: each counts under its own, and all agree under one."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from elastic_tests import MODULUS, elastic

from palpate.analytic import sneddon
from palpate.configuration.settings import Design
from palpate.configuration.study_file import load_study
from palpate.data.study_recordings import check, resampled
from palpate.diagnosis.study_diagnosis import run_diagnosis
from palpate.errors import InputError, PalpateError
from palpate.models import own_loads
from palpate.models.own_loads import brought_to_one_load
from palpate.solver.simulation import simulate_batch
from palpate.workflow_support.steps import calibrate_study, fit_surrogate


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def method():
    """Return a study of three tests on Sneddon's elastic body that one method brought to unlike loads."""
    Path("method").mkdir()
    for k, load in enumerate((1.0, 0.87, 1.13), 1):
        test = elastic(load, 20 * (1 + 0.02 * k))
        replace(test, name="").write(f"method/M_{k}.csv")
    values = {
        "study": "s",
        "material": {"model": "elastic", "poisson_ratio": 0.35},
        "parameters": {"youngs_modulus": [2.0, 4.0]},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "conditions": [{"name": "M", "load_history": "recorded", "own_loads": True}],
        "kinematics": "small",
        "recordings": {"lab": "method"},
    }
    Path("study.yaml").write_text(yaml.safe_dump(values))
    return load_study("study.yaml")


def test_tests_of_one_method_are_brought_to_one_load(method):
    """Each test's depth follows from its own load, and all agree under one."""
    study = method
    observed = resampled(study, check(study, "lab"))
    before = observed["M"].response
    after = brought_to_one_load(study, observed, {"youngs_modulus": MODULUS})["M"].response
    loaded = study.conditions[0].protocol.sample_drive > 0.2
    assert np.ptp(before[:, loaded], axis=0).max() > 0.1 * before.max()
    exact = sneddon.depth(study.conditions[0].protocol.sample_drive, MODULUS, 0.35, 70.3)
    assert after[:, loaded] == pytest.approx(np.tile(exact[loaded], (3, 1)), rel=0.01)


def test_tests_of_one_method_are_calibrated_each_under_its_own_load(method):
    """Their depths differ by an eighth, as their loads by a quarter; none of that is scatter between sites.

    The simulation moves the surface inwards under the cone, which Sneddon neglects: 2 % of the modulus at this ratio,
    where that is not taken for a discrepancy of the law.
    """
    exact = method.calibration.model_copy(update={"law_error": 0.0})
    study = replace(method, design=Design(kind="sobol", points=16), calibration=exact)
    observed = resampled(study, check(study, "lab"))
    contents = [
        {"parameters": cell, "status": "ok", "quantity": "depth", "depth": outcome.depth}
        for cell, outcome in zip(
            study.cells, simulate_batch([study.specification(c, study.conditions[0]) for c in study.cells]), strict=True
        )
    ]
    model, _, _, summary = fit_surrogate(study, "M", contents)
    assert summary["condition_number"] < 1e12
    result = calibrate_study(study, {"M": model}, observed, lambda line: None)
    found = result.parameters["youngs_modulus"]
    assert found.estimate == pytest.approx(MODULUS, rel=0.03)
    assert result.noise["M"]["site_scatter"] < 0.005


def test_tests_of_one_method_are_calibrated_before_they_are_diagnosed(method):
    with pytest.raises(InputError, match="calibrate first"):
        run_diagnosis(method, "lab")


def test_tests_that_cannot_be_brought_to_one_load_end_a_fit(method, monkeypatch):
    failed = SimpleNamespace(status="failed", reason="no contact")
    monkeypatch.setattr(own_loads, "simulate_batch", lambda cases: [failed] * len(cases))
    observed = resampled(method, check(method, "lab"))
    with pytest.raises(PalpateError, match="M: its tests are not brought to one load, as a simulation failed"):
        brought_to_one_load(method, observed, {"youngs_modulus": MODULUS}, own_loads.raise_failure)
