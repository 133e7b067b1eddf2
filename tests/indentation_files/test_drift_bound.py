"""Holds under load bound the drift: creep only adds to the depth."""

import numpy as np
import pytest

from indentation_files.drift_rate import fastest_in
from indentation_files.recording import Recording
from indentation_files.segments import segments
from palpate.diagnosis.constraints import laws_of

LOADING, HOLD = 10.0, 20.0


def held(drift, creep, seed=0, noise=0.1, relaxing=0.0):
    """Loading to 3 mN, a hold in which the depth grows by `creep` (s -> nm), and unloading; in 0.05 s steps."""
    time = np.arange(0.0, 2 * LOADING + HOLD, 0.05)
    load = np.interp(time, [0, LOADING, LOADING + HOLD, 2 * LOADING + HOLD], [0, 3, 3 * (1 - relaxing), 0])
    since = np.clip(time - LOADING, 0.0, HOLD)
    noise = noise * np.random.default_rng(seed).standard_normal(len(time))
    return time, load, 80.0 * np.sqrt(load) + creep(since) + drift * time + noise


CREEPS = {
    "none": lambda s: 0.0 * s,
    "exponential": lambda s: 5.0 * (1.0 - np.exp(-s / 1.5)),
    "logarithm": lambda s: 2.0 * np.log1p(s / 0.5),
    "power law": lambda s: 3.0 * s**0.3,
}


@pytest.mark.parametrize("creep", CREEPS)
@pytest.mark.parametrize("drift", [-0.4, 0.0, 0.5])
def test_the_bound_lies_above_the_drift_whatever_the_creep(creep, drift):
    time, load, depth = held(drift, CREEPS[creep])
    rate, upper = fastest_in(time, load, depth, segments(time, load))
    assert rate <= upper
    assert upper >= drift
    late = np.gradient(CREEPS[creep](np.linspace(0.0, HOLD, 401)), HOLD / 400)[300]
    assert upper <= drift + late + 0.05, "and it is no looser than the creep late in the hold"


def test_a_load_that_falls_in_the_hold_loosens_the_bound():
    """The depth given back would hide drift; the recording is one of relaxing load and no creep."""
    time, load, depth = held(0.3, CREEPS["none"], relaxing=0.02)
    assert fastest_in(time, load, depth, segments(time, load))[1] >= 0.3


def test_the_bound_is_a_law_without_a_lower_end():
    (law,) = laws_of([Recording(*held(0.5, CREEPS["logarithm"]))])
    assert law.key == "thermal_drift"
    assert law.lower == -np.inf
    assert law.row()["lower"] is None
    assert law.allows(0.5, 0.0)
    assert law.allows(-3.0, 0.0)
    assert not law.allows(1.5, 0.1)


def held_low(drift, creep, seed=0):
    """The same test, unloaded to a tenth of its load and held there for 40 s, where it creeps on at `creep` nm/s."""
    time, load, depth = held(drift, CREEPS["logarithm"], seed)
    first = (load >= 0.3) | (time < LOADING)
    rest = np.arange(1, 401) * 0.1
    noise = 0.1 * np.random.default_rng(seed + 1).standard_normal(400)
    low = depth[first][-1] + (drift + creep) * rest + noise
    return (
        np.append(time[first], time[first][-1] + rest),
        np.append(load[first], np.full(400, 0.3)),
        np.append(depth[first], low),
    )


def test_a_hold_at_low_load_says_more_than_the_bound():
    (law,) = laws_of([Recording(*held_low(0.5, 0.0))])
    assert law.lower <= 0.5 <= law.upper
    assert law.upper - law.lower < 0.1


@pytest.mark.parametrize("simulated", [0.15, 0.3, 0.6])
def test_creep_at_low_load_is_taken_off_and_need_not_be_known_well(simulated):
    """It is 0.28 nm/s here; the law holds the drift where the simulation has half of it or all that is seen."""
    test = Recording(*held_low(0.3, 0.28))
    (naive,) = laws_of([test])
    assert naive.lower > 0.3, "all is taken for drift"
    (law,) = laws_of([test], [Recording(*held_low(0.0, simulated))])
    assert law.lower <= 0.3 <= law.upper
    assert law.upper - law.lower == pytest.approx(naive.upper - naive.lower + 2 * simulated, abs=0.02)


def test_where_the_hold_was_not_simulated_only_the_bound_is_left():
    (law,) = laws_of([Recording(*held_low(0.3, 0.28))], [])
    assert law.lower == -np.inf
