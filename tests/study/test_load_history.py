"""Load histories: constant strain rate and cycles, the laws they are made for and what they refuse; recorded ones."""

import numpy as np
import pytest

from palpate.errors import InputError
from palpate.solver.simulation import simulate, specification_from
from palpate.study.load_history import constant_strain_rate, cycles, protocol_from
from palpate.study.protocol import trapezoid
from palpate.study.recorded_history import recorded
from studies.verification.reference_materials import BURGERS as EPOXY

CREEP = {"model": "nonlinear_burgers", **EPOXY}
CONE = {"shape": "cone", "half_angle": 70.3}


def simulated(material, protocol):
    simulation = simulate(
        specification_from({"material": material, "indenter": CONE, "protocol": protocol, "kinematics": "small"})
    )
    assert simulation.status == "ok", simulation.reason
    return simulation


def test_load_grows_at_twice_the_strain_rate():
    protocol = constant_strain_rate(2.0, 0.05, 0.01, 10.0, 5.0, points=80)
    rise, loaded = 10.0, 10.0 + np.log(100.0) / 0.1
    time = np.linspace(rise, loaded, 1000)
    assert protocol.load_at(time) == pytest.approx(0.02 * np.exp(0.1 * (time - rise)), rel=1e-3)
    assert protocol.load_at(np.array([0.0, 5.0, loaded + 10.0, loaded + 15.0])) == pytest.approx([0, 0.01, 2, 0])
    assert len(protocol.sample_time) == 80
    assert np.abs(protocol.sample_time - loaded).min() < 1e-9


def test_depth_grows_at_the_strain_rate_whatever_the_law():
    """A body without a length, loaded by P ~ exp(2 r t) for long, indents as h ~ exp(r t)."""
    settings = {"max_load": 1.0, "strain_rate": 0.1, "start_fraction": 0.001, "unloading_time": 5, "points": 120}
    protocol = protocol_from(settings)
    simulation = simulated(CREEP, settings)
    loaded = np.argmax(simulation.load)
    late = slice(loaded // 2, loaded + 1)
    rate = np.polyfit(protocol.sample_time[late], np.log(simulation.depth[late]), 1)[0]
    assert rate == pytest.approx(0.1, rel=0.01)


def test_an_elastic_body_forgets_its_cycles():
    loads = [0.4, 0.1, 0.7, 0.1, 1.0, 0.0]
    times = [5.0, 8.0, 15.0, 20.0, 30.0, 41.0]
    protocol = {"times": times, "loads": loads, "points": 60}
    simulation = simulated({"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}, protocol)
    at = np.searchsorted(simulation.time, times)
    assert simulation.time[at].tolist() == times
    assert simulation.load[at] == pytest.approx(loads)
    depth = simulation.depth[at]
    assert depth[:5] / np.sqrt(loads[:5]) == pytest.approx(np.full(5, depth[4]), rel=0.01)


def test_cycles_of_a_trapezoid_are_the_trapezoid():
    words = {"max_load": 1.0, "loading_time": 10.0, "hold_time": 4.0, "unloading_time": 7.0, "points": 30}
    one, other = protocol_from(words), cycles([10.0, 14.0, 21.0], [1.0, 1.0, 0.0], 30)
    for name in ("knot_time", "knot_drive", "sample_time"):
        assert getattr(one, name).tolist() == getattr(other, name).tolist()


def test_the_corner_at_contact_may_be_listed():
    listed = protocol_from({"times": [0, 30, 60], "loads": [0, 1, 0]})
    assert listed.knot_time.tolist() == protocol_from({"times": [30, 60], "loads": [1, 0]}).knot_time.tolist()
    assert listed.knot_load.tolist() == [0.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("values", "place"),
    [
        ({"max_load": 1.0, "strain_rate": 0.0, "unloading_time": 5.0}, "strain_rate"),
        ({"max_load": 1.0, "strain_rate": 0.1, "loading_time": 5.0, "unloading_time": 5.0}, "loading_time"),
        ({"max_load": 1.0, "loading_time": 5.0, "start_fraction": 0.1, "unloading_time": 5.0}, "start_fraction"),
        ({"times": [1.0, 2.0], "loads": [1.0]}, "loads"),
        ({"times": [2.0, 1.0], "loads": [1.0, 0.0]}, "times"),
        ({"times": [1.0, float("nan")], "loads": [1.0, 0.0]}, "times"),
        ({"times": [1.0, "x"], "loads": [1.0, 0.0]}, "times"),
        ({"times": [0.0], "loads": [0.0]}, "times"),
        ({"times": [0.0, 1.0], "loads": [0.5, 1.0]}, "loads"),
        ({"loads": [1.0, 0.0]}, "times"),
        ({"times": [1.0, 2.0], "loads": [1.0, 0.0], "hold_time": 1.0}, "hold_time"),
        ({"times": [1.0, 2.0, 3.0], "loads": [1.0, 0.5, 0.0], "points": 5}, "points"),
        ({"max_load": 1.0, "loading_time": 5.0, "unloading_time": 5.0, "points": 21.7}, "points"),
        ({"max_load": 10**400, "loading_time": 5.0, "unloading_time": 5.0}, "max_load"),
    ],
)
def test_bad_values_are_refused_by_name(values, place):
    with pytest.raises(InputError) as caught:
        protocol_from(values)
    assert caught.value.place == place


def test_a_history_that_loads_nothing_is_refused():
    with pytest.raises(InputError, match="positive maximum"):
        protocol_from({"times": [1.0, 2.0], "loads": [0.0, 0.0]})


def test_recorded_history_is_thinned_within_its_tolerance():
    t = np.linspace(0, 60, 5000)
    load = np.interp(t, [0, 30, 40, 60], [0, 5, 5, 0]) + 1e-3 * np.sin(40 * t)
    protocol = recorded(t, load)
    assert len(protocol.knot_time) < 60
    assert np.abs(protocol.load_at(t) - load).max() < 2e-3 * load.max() + 1e-3


def test_trapezoid_samples_all_corners():
    protocol = trapezoid(2.0, 10.0, 3.0, 5.0, points=31)
    assert len(protocol.sample_time) == 31
    for corner in (10.0, 13.0, 18.0):
        assert np.isclose(protocol.sample_time, corner).any()
    assert protocol.sample_load[-1] == 0.0
