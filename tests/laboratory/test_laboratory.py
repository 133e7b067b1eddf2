"""The virtual laboratory: its noise has the covariance it claims, its recordings say what they are and repeat."""

import json
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
import yaml

from indentation_files.recording_file import read_recording
from palpate.configuration.settings import LaboratorySettings
from palpate.configuration.study_file import load_study
from palpate.errors import PalpateError
from palpate.laboratory import virtual
from palpate.solver.simulation import Simulation, simulate_batch
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid

SETTINGS = MappingProxyType(
    {
        "parameters": {"youngs_modulus": 3.0},
        "seed": 4,
        "replicates": 3,
        "noise_nm": 0.0,
        "noise_time": 1.0,
        "site_scatter": 0.0,
    }
)


@pytest.fixture
def study(tmp_path):
    file = tmp_path / "study.yaml"
    content = {
        "study": "s",
        "material": {"model": "elastic", "poisson_ratio": 0.3},
        "parameters": {"youngs_modulus": [2.0, 4.0]},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "points": 10,
        "conditions": [{"name": "a", "max_load": 1.0, "loading_time": 5, "unloading_time": 5}],
        "recordings": {"virtual": str(tmp_path / "virtual")},
        "laboratory": {"virtual": {**SETTINGS, "noise_nm": 1.0, "site_scatter": 0.01}},
    }
    file.write_text(yaml.safe_dump(content))
    return load_study(file)


def test_noise_has_the_covariance_it_claims():
    time = np.array([0.1, 0.4, 1.0, 3.0])
    rng = np.random.default_rng(0)
    noise = np.array([virtual.correlated_noise(time, 1.5, 0.8, rng) for _ in range(40_000)])
    expected = 1.5**2 * np.exp(-np.abs(time[:, None] - time) / 0.8)
    assert np.allclose(noise.T @ noise / len(noise), expected, atol=5 * 1.5**2 / np.sqrt(len(noise)))


def test_a_denser_protocol_holds_every_sample_of_the_one_it_refines():
    protocol = trapezoid(1.0, 30.0, 10.0, 30.0, 50)
    fine = virtual.denser(protocol)
    assert len(fine.sample_time) == 4 * len(protocol.sample_time)
    assert np.array_equal(fine.sample_time[3::4], protocol.sample_time)
    assert (np.diff(fine.sample_time) > 0).all()


@pytest.mark.usefixtures("truth_once")
def test_without_noise_and_scatter_replicates_are_the_same_curve(study):
    recordings = virtual.record(study, LaboratorySettings(**SETTINGS))
    assert list(recordings) == ["a_1", "a_2", "a_3"]
    assert np.array_equal(recordings["a_1"].depth, recordings["a_3"].depth)


@pytest.mark.usefixtures("truth_once")
def test_scatter_between_sites_is_one_factor_for_each_recording(study):
    exact = virtual.record(study, LaboratorySettings(**SETTINGS))["a_1"].depth
    scattered = virtual.record(study, LaboratorySettings(**{**SETTINGS, "site_scatter": 0.05}))
    ratios = np.array([recording.depth / exact for recording in scattered.values()])
    assert np.allclose(ratios, ratios[:, :1])
    assert len(np.unique(ratios[:, 0].round(12))) == 3


@pytest.mark.usefixtures("truth_once")
def test_files_repeat_from_their_seed_say_that_they_are_synthetic_and_keep_the_truth_apart(study, tmp_path):
    for folder in ("one", "two"):
        virtual.write(study, "virtual", tmp_path / folder)
    files = sorted((tmp_path / "one").glob("*.csv"))
    assert [file.name for file in files] == ["a_1.csv", "a_2.csv", "a_3.csv"]
    for file in files:
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes()
        assert file.read_text().startswith("# SYNTHETIC")
        read_recording(file)
        assert "youngs_modulus" not in file.read_text()
    assert json.loads((tmp_path / "one/truth.json").read_text())["parameters"] == {"youngs_modulus": 3.0}


def test_a_truth_that_fails_on_one_mesh_is_tried_on_another(study, monkeypatch):
    specification = study.specification({"youngs_modulus": 3.0}, study.condition("a"), "fine")
    tried = []

    def failing_once(specifications, shift):
        tried.append(shift)
        return [Simulation(*np.ones((3, 1)), "ok" if len(tried) == 2 else "failed", "no equilibrium", 0.0)]

    monkeypatch.setattr(virtual, "simulate_batch", failing_once)
    (found,) = virtual.off_the_mesh([specification], ["a"])
    assert found.status == "ok"
    assert len(set(tried)) == 2
    assert all(0.0 < shift < 1.0 for shift in tried), "its nodes lie between those of a fit's mesh"
    with pytest.raises(PalpateError, match="a: no equilibrium"):
        virtual.off_the_mesh([specification], ["a"])


def test_a_pyramid_keeps_its_mesh_and_is_not_tried_again(study, monkeypatch):
    cone = study.specification({"youngs_modulus": 3.0}, study.condition("a"), "fine")
    specification, tried = replace(cone, indenter=Indenter("berkovich", face_angle=65.27)), []

    def failing(specifications, shift):
        tried.append(shift)
        return [Simulation(*np.ones((3, 1)), "failed", "no equilibrium", 0.0)]

    monkeypatch.setattr(virtual, "simulate_batch", failing)
    with pytest.raises(PalpateError, match="a: no equilibrium"):
        virtual.off_the_mesh([specification], ["a"])
    assert len(tried) == 1


def test_its_curves_share_no_node_with_those_of_a_fit_and_agree_within_grid_convergence(study):
    specification = study.specification({"youngs_modulus": 3.0}, study.condition("a"), "fine")
    (off,), (on,) = virtual.off_the_mesh([specification], ["a"]), simulate_batch([specification])
    assert not np.array_equal(off.depth, on.depth)
    loaded = on.load > 0.05 * on.load.max()
    assert off.depth[loaded] == pytest.approx(on.depth[loaded], rel=study.calibration.solver_error)
