"""Contract of every mechanism found: neutral means nothing, an amplitude is seen, pairs run, bad values fail."""

import itertools

import numpy as np
import pytest

from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.model import simulate, specification_from

BASE = {
    "material": {
        "model": "nonlinear_burgers",
        "youngs_modulus": 3.28,
        "poisson_ratio": 0.34,
        "steady_coefficient": 0.09,
        "steady_exponent": 0.2,
        "transient_coefficient": 0.24,
        "transient_exponent": 0.47,
        "retardation_time": 0.25,
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 28},
}
VISIBLE = {
    "thermal_drift": {"rate": 0.1},
    "frame_compliance": {"compliance": 5.0},
    "zero_offset": {"offset": 4.0},
    "tip_rounding": {"radius": 200.0},
    "tip_angle": {"half_angle": 71.0},
    "second_voigt": {"coefficient": 0.1, "exponent": 0.3, "retardation_time": 10.0},
    "plastic_yield": {"yield_stress": 0.15, "hardening": 0.2},
    "controller_lag": {"lag": 1.0},
    "friction": {"coefficient": 0.25},
}


def depth(mechanisms=None):
    simulation = simulate(specification_from(BASE | {"mechanisms": mechanisms or {}}))
    assert simulation.status == "ok", simulation.reason
    return simulation.depth


@pytest.fixture(scope="module")
def plain():
    return depth()


def test_every_mechanism_has_a_visible_example():
    assert set(VISIBLE) == set(MECHANISMS)


@pytest.mark.parametrize("key", MECHANISMS)
def test_neutral_amplitude_is_the_identity(key, plain):
    assert depth({key: dict(MECHANISMS[key].neutral)}) == pytest.approx(plain, rel=2e-3)


@pytest.mark.parametrize("key", MECHANISMS)
def test_effect_is_visible(key, plain):
    assert np.abs(depth({key: VISIBLE[key]}) - plain).max() > 1.0


@pytest.mark.parametrize("pair", list(itertools.combinations(VISIBLE, 2)), ids="+".join)
def test_pairs_run(pair):
    depth({key: VISIBLE[key] for key in pair})


def test_signs_and_sizes(plain):
    time = np.linspace(2.5, 70, 28)
    load = specification_from(BASE).protocol.sample_load
    assert depth({"thermal_drift": {"rate": 0.1}}) - plain == pytest.approx(0.1 * time, abs=1e-9)
    assert depth({"frame_compliance": {"compliance": 5.0}}) - plain == pytest.approx(5 * load, abs=1e-9)
    peak = np.argmax(load)
    assert depth({"tip_rounding": {"radius": 200.0}})[peak] < plain[peak]
    assert depth({"tip_angle": {"half_angle": 71.0}})[peak] < plain[peak]
    assert depth({"second_voigt": VISIBLE["second_voigt"]})[peak] > plain[peak]
    assert depth({"controller_lag": {"lag": 1.0}})[5] < plain[5]


@pytest.mark.parametrize(
    ("mechanisms", "place"),
    [
        ({"thermal_drft": {"rate": 1}}, "mechanisms"),
        ({"thermal_drift": {"rat": 1}}, "mechanisms.thermal_drift.rat"),
        ({"thermal_drift": {}}, "mechanisms.thermal_drift.rate"),
        ({"tip_rounding": {"radius": -1}}, "mechanisms.tip_rounding.radius"),
        ({"controller_lag": {"lag": -1.0}}, "mechanisms.controller_lag.lag"),
    ],
)
def test_bad_values_are_refused_by_name(mechanisms, place):
    with pytest.raises(InputError) as caught:
        specification_from(BASE | {"mechanisms": mechanisms})
    assert caught.value.place == place


def test_a_mechanism_that_cannot_act_says_so():
    elastic = {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}
    spec = BASE | {"material": elastic, "mechanisms": {"second_voigt": VISIBLE["second_voigt"]}}
    with pytest.raises(InputError, match="no Voigt element"):
        simulate(specification_from(spec))
