"""Where a load leaves the air, without a law: contact lies between the ends, whatever the body does beyond."""

import numpy as np
import pytest

from indentation_files import departure as settings
from indentation_files.departure import departure, faint_rise

CONTACT, AIR = 600.0, 1000.0


def loading(exponent=1.5, noise=1e-3, tilt=0.0, drop=0.0, seed=0, size=3000):
    """Load and depth: 1000 nm of air, 1000 nm beyond contact at 600 nm; it may fall where it is 0.4 of its largest."""
    way = np.linspace(-AIR, 1000.0, size) / 1000.0
    load = np.clip(way, 0.0, None) ** exponent
    load *= np.where(load > 0.4, 1.0 - drop * np.exp(-(way - 0.4 ** (1 / exponent)) / 0.1), 1.0)
    load += tilt * way + noise * np.random.default_rng(seed).standard_normal(size)
    return load, CONTACT + 1000.0 * way


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("tilt", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("drop", [0.0, 0.2])
def test_contact_lies_between_the_ends(exponent, tilt, drop):
    found = departure(*loading(exponent, tilt=tilt, drop=drop))
    assert found.earliest < CONTACT < found.clear <= found.loaded
    assert found.earliest <= found.likely <= found.clear


def test_ends_scale_with_load_and_depth_and_move_with_them():
    load, depth = loading()
    plain, moved = departure(load, depth), departure(5.0 * load + 7.0, 3.0 * depth - 100.0)
    for end in ("earliest", "likely", "clear", "loaded"):
        assert getattr(moved, end) == pytest.approx(3.0 * getattr(plain, end) - 100.0, abs=1e-6)


def test_less_noise_brings_the_ends_together():
    found = [departure(*loading(noise=noise)) for noise in (1e-2, 1e-3, 1e-4)]
    ways = [one.clear - one.earliest for one in found]
    assert ways[0] > ways[1] > ways[2]


def test_a_load_along_a_straight_line_leaves_no_air():
    depth = np.linspace(0.0, 1000.0, 500)
    assert departure(1e-3 * depth, depth) is None
    assert departure(depth[:10], depth[:10]) is None


def test_a_contact_that_the_air_contradicts_is_replaced_and_any_other_kept():
    found = departure(*loading(drop=0.2))
    kept = (CONTACT, CONTACT - 5.0, CONTACT + 5.0)
    assert found.mended(*kept) == kept
    for wrong in (CONTACT + 700.0, CONTACT - 900.0):
        contact, lower, upper = found.mended(wrong, wrong - 5.0, wrong + 5.0)
        assert lower < CONTACT < upper
        assert lower <= contact <= upper


@pytest.mark.parametrize("name", ["MORE", "SPREAD", "MATTERS", "FREE", "BEYOND_DOUBT", "LONG"])
@pytest.mark.parametrize("times", [0.5, 2.0])
def test_what_is_replaced_does_not_hang_on_a_chosen_number(monkeypatch, name, times):
    monkeypatch.setattr(settings, name, times * getattr(settings, name))
    found = departure(*loading(drop=0.2))
    kept = (CONTACT, CONTACT - 5.0, CONTACT + 5.0)
    assert found.mended(*kept) == kept
    assert found.mended(CONTACT + 700.0, CONTACT + 695.0, CONTACT + 705.0)[0] < CONTACT + 100.0


def air(rise=0.0, wave=0.0, tilt=0.0, noise=1e-3, seed=1):
    """Air of 1000 nm whose load may rise from 400 nm on as under a sphere, or wave with a period of 300 nm."""
    depth = np.linspace(0.0, 1000.0, 600)
    load = rise * np.clip(depth / 600.0 - 2 / 3, 0.0, None) ** 1.5 + tilt * depth / 1000.0
    load += wave * np.sin(2 * np.pi * depth / 300.0)
    return load + noise * np.random.default_rng(seed).standard_normal(len(depth)), depth


@pytest.mark.parametrize("tilt", [-0.1, 0.0, 0.1])
@pytest.mark.parametrize("rise", [8e-3, 3e-2])
def test_a_faint_rise_begins_where_a_soft_layer_is_touched(rise, tilt):
    load, depth = air(rise, tilt=tilt)
    assert 200.0 < faint_rise(load, depth, 1e-3) <= 410.0


@pytest.mark.parametrize("disturbed", [{}, {"tilt": 0.1}, {"wave": 5e-3}, {"wave": 5e-3, "rise": 8e-3}, {"rise": 5e-4}])
def test_no_faint_rise_in_air_that_is_straight_or_waves(disturbed):
    load, depth = air(**disturbed)
    assert faint_rise(load, depth, 1e-3) is None
