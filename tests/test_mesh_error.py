"""Error of the mesh where a mechanism acts, against simulations on the fine mesh that took no part in learning it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from palpate import snapshots
from palpate.config import load_study
from palpate.diagnosis.design import amplitudes, middle, plan, refinements, scale_of
from palpate.diagnosis.effects import depth_ratio, fit_effects, linear
from palpate.mechanisms import MECHANISMS
from palpate.model import simulate, smooth

STUDY = {
    "study": "meshes",
    "points": 16,
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34},
    "parameters": {
        "youngs_modulus": [2.6, 3.3, 4.0],
        "steady_coefficient": [0.06],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.25],
        "transient_exponent": [0.3],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "T010", "max_load": 1.0, "loading_time": 10, "unloading_time": 10}],
    "diagnosis": {"mechanisms": ["plastic_yield", "thermal_drift"], "snapshots": 8},
}


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    file = tmp_path_factory.mktemp("meshes") / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY))
    return load_study(file)


def test_a_plane_through_the_quarters_gives_value_and_slopes():
    corners = np.array([[0.25, 0.25], [0.25, 0.75], [0.75, 0.25], [0.75, 0.75]])
    values = 3.0 + np.outer(corners @ [2.0, -1.0], [1.0, 10.0])
    assert linear(list(corners), list(values)) == pytest.approx(np.array([[3.5, 8.0], [2.0, 20.0], [-1.0, -10.0]]))


def test_only_what_adds_an_error_is_simulated_on_the_fine_mesh(study):
    (condition,) = study.conditions
    assert refinements(study, condition, "thermal_drift") == []
    found = refinements(study, condition, "plastic_yield")
    assert [fine.specification.accuracy for _, _, fine in found] == ["fine"] * 4
    assert all(usual.specification.accuracy == "standard" for _, usual, _ in found)


def test_yielding_comes_out_as_on_the_fine_mesh(study, tmp_path):
    """Another amplitude and another modulus than those it was learnt from."""
    (condition,) = study.conditions
    batches = plan(study, tmp_path)
    for batch in batches:
        snapshots.compute(batch, tmp_path / "store")
    effects = fit_effects(study, condition, Path(batches[0].files[0]).parent)
    x = np.array([0.35, 0.6])
    acting = {"plastic_yield": amplitudes(MECHANISMS["plastic_yield"], scale_of(study), x)}
    cell = middle(study) | {"youngs_modulus": 3.7}
    usual, fine = (replace(study.specification(cell, condition, a), mechanisms=acting) for a in ("standard", "fine"))
    true, rough = simulate(replace(fine, meshes=2)).depth, effects.refinement * simulate(smooth(usual)).depth
    corrected = rough * (1.0 + effects.mechanisms["plastic_yield"].mesh_share(x))
    deep = true > 0.3 * true.max()
    off, before = (np.sqrt(np.mean((depth / true - 1.0)[deep] ** 2)) for depth in (corrected, rough))
    assert off < 0.5 * study.calibration["solver_error"]
    assert off < 0.5 * before


def test_where_a_body_is_unloaded_no_mesh_errs():
    assert depth_ratio(np.array([2.02, 1.01, 1e-14]), np.array([2.0, 1.0, -4e-15])) == pytest.approx([1.01, 1.01, 1.0])
