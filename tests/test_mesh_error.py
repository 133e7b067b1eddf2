"""Error of the mesh in a diagnosis: one factor of the base model, against simulations on the fine mesh."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from palpate.config import load_study
from palpate.diagnosis.design import amplitudes, middle, refinement, scale_of
from palpate.diagnosis.effects import depth_ratio
from palpate.mechanisms import MECHANISMS
from palpate.model import simulate

STUDY = {
    "study": "refined",
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
}


@pytest.mark.parametrize("share", [0.35, 0.8])
def test_the_base_models_factor_serves_a_body_that_yields(tmp_path, share):
    """Of another modulus, too: within the error of grid convergence, which the study states."""
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    study = load_study(tmp_path / "study.yaml")
    (condition,) = study.conditions
    usual, fine = (simulate(snapshot.specification).depth for snapshot in refinement(study, condition))
    acting = {"plastic_yield": amplitudes(MECHANISMS["plastic_yield"], scale_of(study), np.array([share, 0.6]))}
    cell = middle(study) | {"youngs_modulus": 3.7}
    found, true = (
        simulate(replace(study.specification(cell, condition, accuracy), mechanisms=acting)).depth
        for accuracy in ("standard", "fine")
    )
    loaded = condition.protocol.sample_load > 0.05 * condition.protocol.max_load
    off = depth_ratio(fine, usual) * found / true - 1.0
    assert np.sqrt(np.mean(off[loaded] ** 2)) < study.calibration["solver_error"]


def test_where_a_body_is_unloaded_no_mesh_errs():
    assert depth_ratio(np.array([2.02, 1.01, 1e-14]), np.array([2.0, 1.0, -4e-15])) == pytest.approx([1.01, 1.01, 1.0])
