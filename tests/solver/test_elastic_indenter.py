"""An elastic indenter: Hertz' and Sneddon's pairs of elastic bodies, and what it leaves alone."""

import numpy as np
import pytest

from palpate.analytic import hertz
from palpate.errors import InputError
from palpate.output.export import FORMATS
from palpate.solver.simulation import simulate, specification_from
from palpate.solver.store import address
from palpate.study.indenter import Indenter

GLASS = {"model": "elastic", "youngs_modulus": 72.0, "poisson_ratio": 0.18}
DIAMOND = {"modulus": 1141.0, "poisson_ratio": 0.07}
PROTOCOL = {"max_load": 1.0, "loading_time": 1, "unloading_time": 1, "points": 20}


def specification(indenter, material=GLASS):
    return specification_from({"material": material, "indenter": indenter, "protocol": PROTOCOL, "kinematics": "small"})


def depth(indenter, material=GLASS):
    simulation = simulate(specification(indenter, material))
    assert simulation.status == "ok", simulation.reason
    return simulation.depth[:10]


def test_two_equal_bodies_have_half_the_modulus_of_one():
    sphere = {"shape": "sphere", "radius": 1e5, "modulus": 72.0, "poisson_ratio": 0.18}
    expected = hertz.depth(0.1 * np.arange(1, 11), 36.0, 0.18, 1e5)
    assert depth(sphere)[3:] == pytest.approx(expected[3:], rel=0.01)


def test_depths_under_a_cone_go_with_the_root_of_the_reduced_modulus():
    cone = {"shape": "cone", "half_angle": 70.3}
    reduced = 1.0 / ((1 - 0.18**2) / 72.0 + (1 - 0.07**2) / 1141.0)
    ratio = np.sqrt(72.0 / (1 - 0.18**2) / reduced)
    assert depth(cone | DIAMOND) == pytest.approx(ratio * depth(cone), rel=1e-6)


def test_a_tip_of_great_modulus_is_rigid():
    plastic = GLASS | {"model": "bilinear_plasticity", "yield_stress": 5.0, "hardening": 10.0}
    cone = {"shape": "cone", "half_angle": 70.3}
    assert depth(cone | {"modulus": 5000.0}, plastic) == pytest.approx(depth(cone, plastic), rel=0.01)
    assert Indenter.from_mapping(cone).compliance == 0.0


def test_the_tip_is_in_the_address_of_a_snapshot():
    cone = {"shape": "cone", "half_angle": 70.3}
    assert address(specification(cone)) != address(specification(cone | DIAMOND))


@pytest.mark.parametrize("wrong", [{"modulus": -1.0}, {"modulus": 1141.0, "poisson_ratio": 0.6}])
def test_impossible_tips_are_refused(wrong):
    with pytest.raises(InputError, match="outside its range"):
        specification({"shape": "cone", "half_angle": 70.3} | wrong)


@pytest.mark.parametrize("key", FORMATS)
def test_no_deck_holds_an_elastic_tip(key, tmp_path):
    with pytest.raises(InputError, match="elastic indenter"):
        FORMATS[key].write(specification({"shape": "cone", "half_angle": 70.3} | DIAMOND), tmp_path / "deck.inp")
