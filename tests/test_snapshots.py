"""Addresses, the store, and what happens to failures."""

import numpy as np
import pytest
import yaml

from palpate import snapshots
from palpate.config import load_study
from palpate.errors import PalpateError
from palpate.fingerprint import without_docstrings
from palpate.model import Simulation, simulate

STUDY = {
    "study": "s",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [1.0, 2.0, 3.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "points": 10,
    "cells_per_job": 2,
    "conditions": [
        {"name": "a", "max_load": 1.0, "loading_time": 1, "unloading_time": 1},
        {"name": "v", "max_load": 2.0, "loading_time": 1, "unloading_time": 1, "role": "validate"},
    ],
}


def study(folder, **changes):
    file = folder / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY | changes))
    return load_study(file)


def fake(specifications):
    return [linear(specification) for specification in specifications]


def linear(specification):
    t = specification.protocol.sample_time
    depth = specification.parameters["youngs_modulus"] * t
    return Simulation(t, specification.protocol.sample_load, depth, "ok", "", 0.1)


def failing(specifications):
    return [failed(s) if s.parameters["youngs_modulus"] == 2.0 else linear(s) for s in specifications]


def failed(specification):
    t = specification.protocol.sample_time
    return Simulation(t, t, np.full(len(t), np.nan), "failed", "no equilibrium", 0.1)


def run(study, folder, solve=fake):
    return [snapshots.compute(b, folder, lambda line: None, solve) for b in snapshots.plan(study, folder)]


def test_only_calibrate_conditions_are_planned_in_batches(tmp_path):
    batches = snapshots.plan(study(tmp_path), tmp_path)
    assert [len(batch.files) for batch in batches] == [2, 1]
    assert [batch.under("a") for batch in batches] == [list(batch.files) for batch in batches]
    assert not any(batch.under("v") for batch in batches)


def test_nothing_is_computed_twice_across_levels_and_studies(tmp_path):
    assert run(study(tmp_path), tmp_path) == [2, 1]
    assert run(study(tmp_path), tmp_path) == [0, 0]
    assert run(study(tmp_path, parameters={"youngs_modulus": [1.0, 1.5, 2.0, 3.0]}), tmp_path) == [1, 0]
    assert run(study(tmp_path, study="other"), tmp_path) == [0, 0]


@pytest.mark.parametrize(
    ("indenter", "solved"),
    [({"shape": "cone", "half_angle": 70.3}, [3, 3]), ({"shape": "sphere", "radius": 5000.0}, [3, 3, 3])],
)
def test_conditions_that_differ_in_size_alone_share_their_simulations(tmp_path, simulated, indenter, solved):
    """Two of three: one lasts longer. Under a sphere, which is a length, none do."""
    conditions = [
        {"name": name, "max_load": load, "loading_time": time, "unloading_time": 1}
        for name, load, time in (("a", 1.0, 1), ("slow", 1.0, 5), ("b", 4.0, 1))
    ]
    s = study(tmp_path, conditions=conditions, indenter=indenter, cells_per_job=3, diagnosis={"enabled": False})
    batches = snapshots.plan(s, tmp_path)
    for batch in batches:
        snapshots.compute(batch, tmp_path, lambda line: None)
    assert simulated == solved
    for condition in s.conditions:
        files = [file for batch in batches for file in batch.under(condition.name)]
        assert len(files) == 3
        for file in files:
            stored = snapshots.read(file)
            alone = simulate(s.specification(stored["parameters"], condition))
            assert f"/{condition.name}/" in file
            assert stored["condition"] == condition.name
            assert stored["load"] == pytest.approx(alone.load)
            assert stored["depth"] == pytest.approx(alone.depth, rel=1e-6, abs=1e-4)


@pytest.mark.parametrize(
    "change",
    [
        {"material": {"model": "elastic", "poisson_ratio": 0.31}},
        {"indenter": {"shape": "cone", "half_angle": 70.0}},
        {"kinematics": "small"},
        {"accuracy": "fine"},
        {"points": 11},
    ],
)
def test_whatever_decides_the_curve_changes_the_address(tmp_path, change):
    one, other = study(tmp_path), study(tmp_path, **change)
    files = [set(f for b in snapshots.plan(s, tmp_path) for f in b.files) for s in (one, other)]
    assert not files[0] & files[1]


def test_a_failure_is_kept_with_its_reason_and_left_out_of_the_matrix(tmp_path):
    s = study(tmp_path)
    run(s, tmp_path, failing)
    files = [f for b in snapshots.plan(s, tmp_path) for f in b.files]
    assert list(snapshots.index(files)["status"]) == ["ok", "failed", "ok"]
    parameters, curves, failures = snapshots.matrix(files, s.levels)
    assert parameters.ravel().tolist() == [1.0, 3.0]
    assert len(curves) == 2
    assert "no equilibrium" in failures[0]
    with pytest.raises(PalpateError, match="no equilibrium"):
        snapshots.matrix(files[1:2], s.levels)


def test_a_killed_job_leaves_no_half_file(tmp_path):
    def killed(specifications):
        raise KeyboardInterrupt

    s = study(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        run(s, tmp_path, killed)
    assert not list(tmp_path.rglob("*.npz"))


def test_a_killed_job_keeps_what_it_solved_before(tmp_path, monkeypatch):
    def killed_at_the_third(specifications):
        if specifications[0].parameters["youngs_modulus"] == 3.0:
            raise KeyboardInterrupt
        return fake(specifications)

    monkeypatch.setattr(snapshots, "AT_ONCE", 2)
    s = study(tmp_path, cells_per_job=3)
    with pytest.raises(KeyboardInterrupt):
        run(s, tmp_path, killed_at_the_third)
    assert run(s, tmp_path) == [1]


def test_fingerprint_ignores_comments_and_docstrings_but_not_formulas():
    import ast

    plain, commented, other = '"""A."""\nx = 1\n', '"""B."""\nx = 1  # one\n', "x = 2\n"
    dumps = [ast.dump(without_docstrings(ast.parse(code))) for code in (plain, commented, other)]
    assert dumps[0] == dumps[1]
    assert dumps[0] != dumps[2]
