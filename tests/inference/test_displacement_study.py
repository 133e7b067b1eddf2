"""Displacement control above the solver: words, recordings, what answers, noise and errors in mN beside nm."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.configuration.settings import CalibrationSettings
from palpate.configuration.study_file import load_study
from palpate.data.measures import error_measures
from palpate.data.observation import Observation
from palpate.data.recording_checks import check_drive
from palpate.data.study_recordings import check_given, observations
from palpate.errors import InputError
from palpate.inference.calibrate import calibrate
from palpate.inference.covariance import model_covariance
from palpate.inference.problem import Problem
from palpate.laboratory.virtual import disturbed
from palpate.mechanisms import Scale
from palpate.observables import OBSERVABLES, Quantity, response_to
from palpate.solver.simulation import Simulation
from palpate.solver.store import address
from palpate.study.alignment import aligned
from palpate.study.indenter import Indenter
from palpate.study.load_history import protocol_from
from palpate.study.protocol import DISPLACEMENT, trapezoid
from palpate.surrogate import PODRBF
from studies.thesis.surrogate_forward import SurrogateForward

CONE = Indenter("cone", 70.3)
LOAD = OBSERVABLES["load"]
SPRING = 0.004
WORDS = {
    "drive": "displacement",
    "max_displacement": 400.0,
    "spring": SPRING,
    "loading_time": 5,
    "hold_time": 20,
    "unloading_time": 5,
}
STUDY = {
    "study": "s",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [2.0, 4.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "points": 40,
    "conditions": [{"name": "D", **WORDS}],
    "recordings": {"measured": "measured"},
}


def elastic_recording(modulus=3.0, protocol=None, name="D_1", factor=1.0):
    """Return what Sneddon's cone answers through the spring: z = h + c h^2 / k."""
    protocol = protocol or protocol_from(WORDS | {"points": 400})
    time, z = np.append(0.0, protocol.sample_time), np.append(0.0, protocol.sample_drive)
    c = factor * 2e-6 / np.pi * modulus / (1 - 0.3**2) * np.tan(np.radians(70.3))
    depth = 2 * z / (1 + np.sqrt(1 + 4 * c / SPRING * z))
    return Recording(time, c * depth**2, depth, name)


def loaded(tmp_path, monkeypatch, **condition):
    monkeypatch.chdir(tmp_path)
    values = STUDY | {"conditions": [{**STUDY["conditions"][0], **condition}]}
    values["conditions"][0] = {key: value for key, value in values["conditions"][0].items() if value is not None}
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(values))
    return load_study("study.yaml")


FOLLOWING = {"max_displacement": None, "loading_time": None, "hold_time": None, "unloading_time": None}


def test_words_of_a_displacement():
    protocol = protocol_from(WORDS)
    assert (protocol.control, response_to(protocol).name, protocol.compliance) == ("displacement", "load", 1 / SPRING)
    assert protocol.sample_drive.max() == 400.0
    corners = protocol_from({"drive": "displacement", "times": [5, 25, 30], "displacements": [400, 400, 0]})
    assert corners.compliance == 0.0
    assert corners.drive_at(np.array([2.5, 10.0])) == pytest.approx([200.0, 400.0])


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"drive": "force"}, "drive"),
        ({"drive": "load"}, "spring"),
        ({"spring": 0.0}, "spring"),
        ({"max_load": 1.0}, "max_load"),
        ({"strain_rate": 0.1}, "strain_rate"),
        ({"max_displacement": -1.0}, "max_displacement"),
    ],
)
def test_bad_words_are_refused_by_name(change, place):
    with pytest.raises(InputError) as caught:
        protocol_from(WORDS | change)
    assert caught.value.place == place


def test_a_curve_is_addressed_by_what_is_prescribed_and_the_spring(tmp_path, monkeypatch):
    study = loaded(tmp_path, monkeypatch)
    condition = study.conditions[0]
    protocol = condition.protocol
    others = [
        replace(protocol, compliance=0.0),
        replace(protocol, control="load", compliance=0.0),
        replace(protocol, compliance=2 * protocol.compliance),
    ]
    found = {
        address(study.specification({"youngs_modulus": 3.0}, replace(condition, protocol=each)))
        for each in (protocol, *others)
    }
    assert len(found) == 4


def test_recordings_give_the_drive(tmp_path, monkeypatch):
    """Depth and load / spring add up to the displacement, which is followed; a file may give it alone."""
    (tmp_path / "measured").mkdir()
    recording = elastic_recording()
    recording.write(tmp_path / "measured/D_1.csv")
    table = np.column_stack([recording.time, recording.depth + recording.load / SPRING])
    np.savetxt(tmp_path / "z.csv", table, delimiter=",", header="time_s,displacement_nm", comments="")
    for source in ("recorded", "z.csv", "measured/D_1.csv"):
        study = loaded(tmp_path, monkeypatch, load_history=source, **FOLLOWING)
        protocol = study.conditions[0].protocol
        assert (protocol.control, protocol.compliance) == ("displacement", 1 / SPRING)
        at = np.linspace(0.0, 30.0, 61)
        assert protocol.drive_at(at) == pytest.approx(np.interp(at, [0, 5, 25, 30], [0, 400, 400, 0]), abs=0.5)
    (tmp_path / "p.csv").write_text("time_s,load_mN\n0,0\n5,1\n30,0\n")
    with pytest.raises(InputError, match="displacement is prescribed"):
        loaded(tmp_path, monkeypatch, load_history="p.csv", **FOLLOWING)


def test_what_is_observed_is_the_load(tmp_path, monkeypatch):
    (tmp_path / "measured").mkdir()
    recording = elastic_recording()
    recording.write(tmp_path / "measured/D_1.csv")
    study = loaded(tmp_path, monkeypatch)
    check_given(study)
    item = observations(study, "measured")["D"]
    assert item.quantity.name == "load"
    expected = elastic_recording(protocol=study.conditions[0].protocol).load[1:]
    assert item.mean == pytest.approx(expected, rel=1e-3, abs=1e-3 * expected.max())


def test_recordings_under_another_displacement_are_refused(tmp_path, monkeypatch):
    (tmp_path / "measured").mkdir()
    elastic_recording(protocol=trapezoid(300.0, 5, 20, 5, 100, DISPLACEMENT)).write(tmp_path / "measured/D_1.csv")
    study = loaded(tmp_path, monkeypatch)
    with pytest.raises(InputError, match="largest displacement is 300 nm, the condition's is 400 nm"):
        check_given(study)


def test_clocks_are_aligned_by_the_displacement():
    protocol = protocol_from(WORDS | {"points": 400})
    late = replace(elastic_recording(), time=elastic_recording().time + 0.6)
    brought = aligned(late, protocol)
    check_drive(protocol, brought)
    assert brought.time[0] == pytest.approx(late.time[late.time > 0.6][0] - 0.6, abs=0.02)


@pytest.mark.parametrize("compliance", [0.0, 20.0, 250.0, 1e5])
def test_errors_in_nm_are_those_under_the_same_load(compliance):
    """A body that is e softer answers with less; under the load of the other it would lie e h / 2 deeper (Sneddon)."""
    protocol = trapezoid(400.0, 5, 20, 5, 60, DISPLACEMENT, compliance)

    def load(c):
        z = protocol.sample_drive
        depth = 2 * z / (1 + np.sqrt(1 + 4 * c * compliance * z))
        return c * depth**2, depth

    (usual, depth), (softer, _) = load(1e-5), load(0.999e-5)
    quantity = Quantity.of(LOAD, protocol, CONE, usual)
    peak = np.argmax(usual)
    assert quantity.nm * (usual - softer)[peak] == pytest.approx(0.5e-3 * depth[peak], rel=2e-3)
    assert softer[peak] / usual[peak] - 1 == pytest.approx(0.5e-3 * quantity.share, rel=2e-3)
    told = error_measures(usual, softer, quantity)
    assert told["rmse_mN"] == pytest.approx(np.sqrt(np.mean((usual - softer) ** 2)))
    assert told["rmse_nm"] == pytest.approx(quantity.nm * told["rmse_mN"])


def test_the_solver_errs_by_as_much_whatever_is_prescribed():
    protocol = trapezoid(400.0, 5, 20, 5, 60, DISPLACEMENT)
    load = 1e-5 * protocol.sample_drive**2
    quantity = Quantity.of(LOAD, protocol, CONE, load)
    assert quantity.share == pytest.approx(-2.0)
    covariance = model_covariance({"pushed": load}, 0.003, {"pushed": quantity.share})
    assert np.sqrt(np.diag(covariance)) == pytest.approx(0.006 * load, rel=1e-9)


def test_the_laboratory_records_what_the_spring_leaves(tmp_path, monkeypatch):
    study = loaded(tmp_path, monkeypatch)
    condition = study.conditions[0]
    exact = elastic_recording(protocol=condition.protocol)
    simulation = Simulation(exact.time[1:], exact.load[1:], exact.depth[1:], "ok", "", 0.0, "load")
    noise = np.random.default_rng(0).standard_normal(len(simulation.time))
    load, depth = disturbed(study, condition, simulation, 0.01, noise)
    assert depth + load / SPRING == pytest.approx(condition.protocol.sample_drive)
    assert np.std(load - simulation.load) > 0.0


def test_loads_and_depths_calibrate_one_material_together():
    """A law with two constants, seen under both controls with noise and sites: chi-square and intervals are honest."""
    pushed = trapezoid(400.0, 5, 20, 5, 40, DISPLACEMENT, 20.0)
    pressed = trapezoid(1.0, 5, 20, 5, 40)

    def load(modulus, relaxing):
        c = 1e-5 * modulus * (1 + 0.1 * relaxing * np.exp(-pushed.sample_time / 8))
        return c * (2 * pushed.sample_drive / (1 + np.sqrt(1 + 80 * c * pushed.sample_drive))) ** 2

    def depth(modulus, relaxing):
        c = 1e-5 * modulus * (1 + 0.05 * relaxing * np.exp(-pressed.sample_time / 8))
        return np.sqrt(pressed.sample_load / c)

    grid = np.array([[a, b] for a in np.linspace(2, 4, 6) for b in np.linspace(0, 4, 5)])
    surrogates = {
        name: PODRBF().fit(grid, np.array([form(*x) for x in grid])) for name, form in (("z", load), ("p", depth))
    }
    truth = {"modulus": 3.0, "relaxing": 2.0}
    scale = Scale(depth=400, load=1.0, modulus=3.0, duration=65, loading_time=5, half_angle=70.3, pressure=0.2)
    quantity, ratios = Quantity.of(LOAD, pushed, CONE, load(**truth)), []
    settings = CalibrationSettings(population=40, generations=20)
    for seed in range(5):
        rng = np.random.default_rng(seed)
        sites, noise = 0.01 * rng.standard_normal((2, 4, 1)), rng.standard_normal((2, 4, 40))
        loads = (1 + sites[0] * quantity.share) * load(**truth) + noise[0] / quantity.nm
        observed = {
            "z": Observation(pushed.sample_time, loads, quantity=quantity),
            "p": Observation(pressed.sample_time, (1 + sites[1]) * depth(**truth) + noise[1]),
        }
        bounds = {"modulus": (2, 4), "relaxing": (0, 4)}
        conditions = (Condition("z", "calibrate", pushed), Condition("p", "calibrate", pressed))
        problem = Problem(conditions, observed, SurrogateForward(surrogates, bounds), scale)
        found = calibrate(problem, surrogates, bounds, rng=rng, settings=settings, report=lambda *_: None)
        assert all(found.parameters[name].lower < value < found.parameters[name].upper for name, value in truth.items())
        assert set(found.noise["z"]) == {"sigma_mN", "correlation", "site_scatter", "replicates"}
        ratios.append(found.misfit_ratio)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.25)


def test_the_clock_starts_with_the_displacement():
    """A load that grows with the square of time is lost in noise at first, when the displacement tells the contact."""
    exact = elastic_recording()
    noisy = replace(exact, load=exact.load - 2e-3).at(slice(1, None))
    begun = noisy.from_contact(protocol_from(WORDS | {"points": 400}).drive_of(exact.load, exact.depth)[1:])
    assert begun.time[-1] == pytest.approx(exact.time[-1], abs=0.01)
