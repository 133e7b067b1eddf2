"""Holds under load bound the drift: creep only adds to the depth."""

import numpy as np
import pytest
from creep_holds import CREEPS, HOLD, held, held_low

from indentation_files.drift_rate import fastest_in
from indentation_files.recording import Recording
from indentation_files.segments import segments
from palpate.diagnosis.constraints import laws_of


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
