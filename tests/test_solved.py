"""The solver's curves of a study: no more simulations than differ, and the same curves as one by one."""

import numpy as np
import pytest
import yaml

from palpate.config import load_study
from palpate.errors import PalpateError
from palpate.model import Simulation, simulate
from palpate.solved import SolvedCurves

CREEP = {"steady_exponent": 0.2, "transient_coefficient": 0.2, "transient_exponent": 0.3, "retardation_time": 0.25}
LOADS = {"small": (0.25, 5), "large": (1.0, 5), "slow": (1.0, 20)}


def study_with(tmp_path, indenter):
    file = tmp_path / "study.yaml"
    content = {
        "study": "s",
        "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34, **CREEP},
        "parameters": {"youngs_modulus": [2.0, 4.0], "steady_coefficient": [0.01, 0.1]},
        "indenter": indenter,
        "kinematics": "small",
        "points": 10,
        "conditions": [
            {"name": name, "max_load": load, "loading_time": time, "unloading_time": time}
            for name, (load, time) in LOADS.items()
        ],
        "diagnosis": {"enabled": False},
    }
    file.write_text(yaml.safe_dump(content))
    return load_study(file)


@pytest.mark.parametrize(
    ("indenter", "runs"),
    [({"shape": "cone", "half_angle": 70.3}, [1, 1]), ({"shape": "sphere", "radius": 5000.0}, [1, 1, 1])],
)
def test_what_differs_in_size_alone_is_solved_once(tmp_path, simulated, indenter, runs):
    study, values = study_with(tmp_path, indenter), {"youngs_modulus": 3.0, "steady_coefficient": 0.05}
    curves = SolvedCurves.at(study, [values], "standard")[0]
    found = {name: curves[name] for name in curves}
    assert simulated == runs
    for name, depth in found.items():
        alone = simulate(study.specification(values, study.condition(name), "standard"))
        assert depth == pytest.approx(alone.depth, rel=1e-9)


def test_several_points_are_solved_together(tmp_path, simulated):
    study = study_with(tmp_path, {"shape": "cone", "half_angle": 70.3})
    points = [{"youngs_modulus": modulus, "steady_coefficient": 0.05} for modulus in (2.5, 3.5)]
    found = SolvedCurves.at(study, points, "standard")
    depths = [curves["slow"] for curves in found]
    assert simulated == [2]
    for values, depth in zip(points, depths, strict=True):
        alone = simulate(study.specification(values, study.condition("slow"), "standard"))
        assert depth == pytest.approx(alone.depth, rel=1e-8)


def test_a_failure_names_its_condition(tmp_path, monkeypatch):
    study = study_with(tmp_path, {"shape": "cone", "half_angle": 70.3})
    failed = Simulation(*np.full((3, 10), np.nan), "failed", "no equilibrium", 0.0)
    monkeypatch.setattr("palpate.solved.simulate_batch", lambda specifications: [failed for _ in specifications])
    with pytest.raises(PalpateError, match=r"^small at .*: no equilibrium"):
        SolvedCurves.at(study, [{"youngs_modulus": 3.0, "steady_coefficient": 0.05}], "standard")[0]["small"]
