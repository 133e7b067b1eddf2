"""A loop of the depth sensor: where it opens and closes, and that it follows the depth of the model."""

import numpy as np
import pytest
import yaml
from elastic_study import SETTINGS

from palpate.configuration.study_file import load_study
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.models.finite_elements import FiniteElements
from palpate.solver.study_scale import scale_of
from palpate.solver.variation import through_instrument
from palpate.study.protocol import DISPLACEMENT, trapezoid

KEY = "sensor_hysteresis"
SIZE = 0.01


def added(load, depth):
    return MECHANISMS[KEY].record(np.zeros_like(load), load, depth, {"size": SIZE}) - depth


def test_loading_and_hold_are_as_they_were_and_the_loop_is_closed_and_widest_at_half_the_load():
    protocol = trapezoid(2.0, 10, 10, 10, points=60)
    load = protocol.sample_load
    found = added(load, 500.0 * np.sqrt(load))
    unloading = protocol.sample_time > 20.0
    assert found[~unloading] == pytest.approx(0.0, abs=1e-9)
    assert found[unloading] == pytest.approx(SIZE * 500.0 * np.sqrt(2.0) * np.sin(0.5 * np.pi * load[unloading]))
    assert found[-1] == pytest.approx(0.0, abs=1e-9)


def test_each_unloading_has_a_loop_of_its_own_and_ripple_of_the_load_has_none():
    up, down = np.linspace(0.0, 1.0, 21)[1:], np.linspace(1.0, 0.2, 17)[1:]
    load = np.concatenate([up, down, 0.2 + 1.8 * up, 2.0 + 0.002 * np.sin(np.arange(40.0)), np.linspace(1.9, 0.0, 20)])
    depth = 500.0 * np.sqrt(load)
    found = added(load, depth)
    assert found[20:36].max() == pytest.approx(SIZE * 500.0, rel=1e-3)
    assert found[36:56] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(found[56:96]).max() < 0.02 * SIZE * depth.max()
    assert found[96:].max() == pytest.approx(SIZE * depth.max(), rel=2e-3)


def test_the_model_of_a_study_follows_its_depth(tmp_path):
    """An elastic cone's depth, and so the loop and all derivatives, are in proportion to the root of the compliance."""
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(SETTINGS))
    study = load_study(tmp_path / "study.yaml")
    plain = FiniteElements.of(study, ["A"])
    joined = plain.joined([MECHANISMS[KEY]], scale_of(study))
    u = np.array([0.4])
    place = np.append(u, joined.coordinates.free[1].scaled(SIZE))
    ((curves, slopes),) = plain.tangents([u])
    ((with_loop, its_slopes),) = joined.tangents([place])
    load = study.conditions[0].protocol.sample_load
    assert with_loop["A"] - curves["A"] == pytest.approx(added(load, curves["A"]), abs=1e-9)
    growth = slopes["A"][:, 0] * (with_loop["A"] / curves["A"])
    assert its_slopes["A"][:-1, 0] == pytest.approx(growth[:-1], rel=1e-3)
    assert its_slopes["A"][:, 1] * SIZE == pytest.approx(
        added(load, curves["A"]) * joined.coordinates.free[1].slope(place[1]), abs=1e-6
    )
    body = joined.body.without_instrument(place, study.conditions[0], with_loop["A"])
    assert body == pytest.approx(curves["A"], rel=1e-9, abs=1e-9)


def test_a_prescribed_displacement_is_refused():
    protocol = trapezoid(500.0, 10, 10, 10, points=60, control=DISPLACEMENT)
    with pytest.raises(InputError, match="not linear in the load"):
        through_instrument(protocol, MECHANISMS[KEY], {"size": SIZE})
