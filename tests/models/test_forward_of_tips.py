"""The finite elements of a study with several tips: each curve is that of its tip, and of that tip's effects alone."""

from dataclasses import replace

import numpy as np
import pytest
from study_file import load

from palpate.mechanisms import MECHANISMS
from palpate.models.anchors import anchors_at
from palpate.models.finite_elements import FiniteElements
from palpate.solver.simulation import simulate
from palpate.solver.study_scale import scale_of
from palpate.study.indenter import Indenter

TIMES = {"loading_time": 10, "unloading_time": 10}
KEYS = ("tip_angle", "tip_angle[blunt]")


@pytest.fixture(scope="module")
def forward(tmp_path_factory):
    """Return the finite elements of an elastic body under two cones, with the angles of both, and a sphere."""
    blunt = {"name": "blunt", "shape": "cone", "half_angle": 76}
    study = load(
        tmp_path_factory.mktemp("study"),
        material={"model": "elastic", "poisson_ratio": 0.3},
        parameters={"youngs_modulus": [2.0, 4.0]},
        points=12,
        kinematics="small",
        conditions=[
            {"name": "cone", "max_load": 1.0, **TIMES},
            {"name": "blunt", "max_load": 1.0, **TIMES, "indenter": blunt},
            {"name": "ball", "max_load": 1.0, **TIMES, "indenter": {"name": "ball", "shape": "sphere", "radius": 1e4}},
        ],
    )  # fmt: skip
    names = [condition.name for condition in study.conditions]
    return FiniteElements.of(study, names).joined([MECHANISMS[key] for key in KEYS], scale_of(study))


def test_each_curve_is_that_of_its_tip(forward):
    """Of its nominal shape, in the middle of the ranges."""
    (curves,) = forward.curves([np.full(3, 0.5)])
    tips = {"cone": Indenter("cone", 70.3), "blunt": Indenter("cone", 76.0), "ball": Indenter("sphere", radius=1e4)}
    modulus = forward.coordinates.named(np.full(3, 0.5))["youngs_modulus"]
    for condition in forward.conditions:
        specification = forward.body.study.specification({"youngs_modulus": modulus}, condition)
        alone = simulate(replace(specification, indenter=tips[condition.name], tip=""))
        assert curves[condition.name] == pytest.approx(alone.depth, rel=1e-6)


def test_what_belongs_to_one_tip_moves_no_other_curve(forward):
    """Sneddon: the depth under a cone goes with the root of cot(alpha)."""
    ((curves, slopes),) = forward.tangents([np.full(3, 0.5)])
    moved = {name: np.abs(slope[-6, 1:] / curves[name][-6]) for name, slope in slopes.items()}
    assert moved["ball"] == pytest.approx([0.0, 0.0], abs=1e-9)
    for name, place, angle in (("cone", 0, 70.3), ("blunt", 1, 76.0)):
        width = np.radians(8.0)  # of the range of the angle
        assert moved[name][place] == pytest.approx(width / np.sin(2 * np.radians(angle)), rel=0.02)
        assert moved[name][1 - place] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_a_pyramid_is_anchored_beside_a_sphere(forward):
    """Each tip by its own accurate model: the pyramid in three dimensions, the sphere on a finer mesh."""
    study = forward.body.study
    tips = study.tips | {"blunt": Indenter.from_mapping({"shape": "berkovich"})}
    body = replace(forward.body, study=replace(study, tips=tips), conditions=study.conditions[1:])
    body = replace(body, mechanisms=(), coordinates=FiniteElements.of(study, ["ball"]).coordinates, scale=None)
    anchors = anchors_at(body, np.array([0.5]))
    assert anchors.keys() == {"blunt", "ball"}
    assert not anchors["blunt"].mesh_change.any() and anchors["ball"].mesh_change.any()
    assert study.of_revolution and not body.study.of_revolution
