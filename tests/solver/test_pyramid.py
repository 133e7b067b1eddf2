"""The shape `berkovich` from the outside: its geometry, what accepts it, and what refuses it by name."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from derivatives import sensitivities

from indentation_files.recording_file import read_recording
from palpate.analytic import berkovich, scaling
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.data.observation import Observation
from palpate.diagnosis.candidates import candidates
from palpate.errors import InputError
from palpate.inference.fitting import Fitter
from palpate.inference.problem import Problem
from palpate.models.finite_elements import FiniteElements
from palpate.solver import simulation
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid import newton_3d
from palpate.solver.simulation import simulate, simulate_batch, specification_from
from palpate.solver.store import address, plan
from palpate.study.indenter import Indenter

SPEC = {
    "material": {"model": "elastic", "youngs_modulus": 3.28, "poisson_ratio": 0.34},
    "indenter": {"shape": "berkovich"},
    "protocol": {"max_load": 1.0, "loading_time": 1.0, "unloading_time": 1.0, "points": 4},
    "kinematics": "small",
}
STUDY = {
    "study": "pyramid",
    "material": {"model": "elastic", "poisson_ratio": 0.34},
    "parameters": {"youngs_modulus": [3.0, 3.5]},
    "indenter": {"shape": "berkovich"},
    "kinematics": "small",
    "conditions": [{"name": "P1", "max_load": 1, "loading_time": 1, "unloading_time": 1, "role": "calibrate"}],
    "diagnosis": {"enabled": False},
}
PYRAMID = specification_from(SPEC)


def test_the_equivalent_cone_is_the_textbooks():
    """Fischer-Cripps, Nanoindentation, 3rd ed. (2011), table 1.1: area 24.5 h^2, equivalent half-angle 70.3 degrees."""
    indenter = Indenter.from_mapping({"shape": "berkovich"})
    assert math.degrees(math.atan(1 / indenter.slope)) == pytest.approx(70.3, abs=0.02)
    assert 3 * math.sqrt(3) / indenter.face_slope**2 == pytest.approx(24.5, abs=0.05)


def test_a_specification_becomes_a_recording(tmp_path):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC))
    assert main(["simulate", str(tmp_path / "spec.yaml"), "-o", str(tmp_path / "curve.csv")]) == 0
    curve = read_recording(tmp_path / "curve.csv")
    load, depth = curve.load, curve.depth
    peak = np.argmax(load)
    assert load[peak] == pytest.approx(1.0)
    assert depth[peak] == pytest.approx(berkovich.depth(1.0, 3.28, 0.34), rel=0.01)


def test_load_scaling_is_exact_and_batches_are_single_runs(monkeypatch):
    monkeypatch.setitem(simulation.RESOLUTIONS_3D, "standard", Resolution(growth=1.3, sectors=3))
    scaled, ratio = scaling.load_scaled(PYRAMID, 4.0)
    one, other = simulate_batch([PYRAMID, scaled])
    assert one.depth == pytest.approx(simulate(PYRAMID).depth)
    assert other.depth[:2] == pytest.approx(ratio * one.depth[:2], rel=1e-3)


def test_friction_is_the_indenters_or_a_mechanisms(monkeypatch):
    """The same either way, and less deep than without."""
    monkeypatch.setitem(simulation.RESOLUTIONS_3D, "standard", Resolution(growth=1.3, sectors=3))
    slick = simulate(PYRAMID)
    rough = simulate(specification_from(SPEC | {"indenter": {"shape": "berkovich", "friction": 0.3}}))
    added = simulate(specification_from(SPEC | {"mechanisms": {"friction": {"coefficient": 0.3}}}))
    assert rough.status == "ok"
    assert np.array_equal(rough.depth, added.depth)
    assert np.all(rough.depth[:2] < slick.depth[:2])


def test_a_blunter_pyramid_has_a_blunter_equivalent_cone(monkeypatch):
    """The depth of an elastic pyramid is in proportion to the root of its slope, nearly; nothing happens at 70.3."""
    monkeypatch.setitem(simulation.RESOLUTIONS_3D, "standard", Resolution(growth=1.3, sectors=3))
    same, blunter = (
        simulate(specification_from(SPEC | {"mechanisms": {"tip_angle": {"half_angle": angle}}}))
        for angle in (70.3, 75)
    )
    nominal = simulate(PYRAMID)
    assert same.depth == pytest.approx(nominal.depth, rel=1e-3)
    ratio = math.sqrt(math.tan(math.radians(70.3)) / math.tan(math.radians(75)))
    assert blunter.depth[:2] == pytest.approx(ratio * nominal.depth[:2], rel=0.01)


def test_a_failure_is_reported_not_raised(monkeypatch):
    monkeypatch.setattr(newton_3d, "ITERATIONS", 1)
    outcome = simulate(PYRAMID, radii=1.3 ** np.arange(20))
    assert outcome.status == "failed"
    assert "no equilibrium in 1 iterations" in outcome.reason
    assert np.isnan(outcome.depth).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"indenter": {"shape": "berkovich", "friction": 0.7}}, "friction"),
        ({"indenter": {"shape": "berkovich", "friction": -0.1}}, "friction"),
        ({"indenter": {"shape": "berkovich", "friction": "rough"}}, "friction"),
        ({"indenter": {"shape": "berkovich", "half_angle": 70.3}}, "half_angle"),
        ({"indenter": {"shape": "berkovich", "face_angle": 95}}, "face_angle"),
        ({"mechanisms": {"friction": {"coefficient": 0.7}}}, "mechanisms.friction.coefficient"),
        ({"indenter": {"shape": "berkovich", "radius": -5}}, "radius"),
        ({"mechanisms": {"film_on_substrate": {"thickness": 5.0, "substrate_modulus": 70.0}}}, "less than an element"),
    ],
)
def test_what_it_does_not_know_is_refused_in_one_line(tmp_path, capsys, change, words):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC | change))
    assert main(["simulate", str(tmp_path / "spec.yaml"), "-o", str(tmp_path / "curve.csv")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert words in lines[0]


def test_derivatives_and_decks_are_refused(tmp_path, capsys):
    with pytest.raises(InputError, match="derivatives"):
        sensitivities(PYRAMID, ["youngs_modulus"])
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC))
    arguments = ["export", str(tmp_path / "spec.yaml"), "--format", "calculix", "-o", str(tmp_path / "deck.inp")]
    assert main(arguments) == 2
    assert "pyramid" in capsys.readouterr().err


def test_a_modulus_is_found_under_the_pyramid_by_the_cones_curves(tmp_path):
    """The cone alone would err by some per cent; of the pyramid three curves are simulated at most."""
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(STUDY))
    study = load_study(path)
    protocol = replace(study.conditions[0].protocol, sample_time=np.array([0.5, 1.0]))
    condition = replace(study.conditions[0], protocol=protocol)
    study = replace(study, conditions=(condition,))
    depth = simulate(study.specification({"youngs_modulus": 3.28}, condition)).depth
    forward = FiniteElements.of(study, ["P1"])
    observed = {"P1": Observation(condition.protocol.sample_time, depth[None])}

    def modulus(forward):
        fitter = Fitter(replace(Problem.of(study, observed), forward=forward), 1e-3, 0.0)
        fit = fitter.base([forward.coordinates.scaled({"youngs_modulus": 3.1})])
        return forward.coordinates.named(fit.z)["youngs_modulus"]

    assert modulus(forward) == pytest.approx(3.28, rel=2e-4)
    assert modulus(replace_record(forward)) > 1.03 * 3.28


def replace_record(forward):
    """Return a forward model that takes the equivalent cone for the pyramid."""
    cone = replace(forward.body.study, indenter=forward.body.study.indenter.equivalent_cone)
    return replace(forward, body=replace(forward.body, study=cone))


def test_a_study_and_its_diagnosis_take_it(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(STUDY))
    study = load_study(path)
    specification = study.specification(study.cells[0], study.conditions[0])
    assert specification.indenter == PYRAMID.indenter
    blunter = replace(specification, indenter=replace(specification.indenter, face_angle=66.0))
    assert address(blunter) != address(specification)
    (snapshot, *_) = plan(study)[0].snapshots
    assert snapshot.specification.indenter == PYRAMID.indenter.equivalent_cone
    assert set(candidates(study)) >= {"friction", "tip_rounding", "frame_compliance", "thermal_drift"}


def test_the_equivalent_cone_keeps_all_but_the_shape():
    tip = Indenter.from_mapping({"shape": "berkovich", "radius": 50.0, "friction": 0.2, "modulus": 1141.0})
    cone = tip.equivalent_cone
    assert (cone.shape, cone.radius, cone.friction, cone.modulus) == ("sphero_cone", 50.0, 0.2, 1141.0)
    assert cone.slope == pytest.approx(tip.slope)
    assert cone.equivalent_cone is cone
