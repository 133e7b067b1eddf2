"""Exact laws beside a diagnosis: what recordings say by themselves, and explanations that contradict it."""

import numpy as np
import pytest
from diagnosis_problem import fitted, problem, recordings
from load_cycles import cycles

from indentation_files.recording import Recording
from palpate.diagnosis.constraints import contradicted, laws_of, zero_points
from palpate.diagnosis.undetected import undetected_effects
from palpate.errors import InputError
from palpate.inference.amplitude_constraint import AmplitudeConstraint


def law(estimate, half, key="thermal_drift", parameter="rate"):
    return AmplitudeConstraint(key, parameter, estimate, estimate - half, estimate + half, "a test")


@pytest.fixture(scope="module")
def drifting():
    """A fit whose drift is 0.3 nm/s."""
    observed = recordings(np.random.default_rng(5), lambda c, r: 0.3 * c.protocol.sample_time)
    return fitted(problem(observed), ("thermal_drift",))


def test_an_explanation_must_agree_with_the_law(drifting):
    assert contradicted(drifting, [law(0.3, 0.01)]) == []
    assert contradicted(drifting, [law(0.0, 0.005)]) == [law(0.0, 0.005)]
    assert contradicted(drifting, [law(0.0, 5.0)]) == [], "a law that knows nothing forbids nothing"


def test_what_is_not_named_is_zero(drifting):
    frame = law(0.8, 0.1, "frame_compliance", "compliance")
    assert contradicted(drifting, [frame]) == [frame]
    base = fitted(drifting.problem)
    assert contradicted(base, [law(0.012, 0.002)]) == [], "a slow drift is background"
    assert contradicted(base, [law(0.3, 0.01)]) == [law(0.3, 0.01)]


def test_recordings_speak_by_themselves():
    time, load = cycles()
    rest = np.arange(1, 201) * 0.5
    time, load = np.append(time, time[-1] + rest), np.append(load, np.full(200, load[-1]))
    noise = 0.05 * np.random.default_rng(2).standard_normal(len(time))
    depth = 80.0 * np.sqrt(load) + 0.9 * load + 0.07 * time + noise
    found = {item.key: item for item in laws_of([Recording(time, load, depth)] * 2)}
    assert found["thermal_drift"].estimate == pytest.approx(0.07, abs=0.005)
    assert found["frame_compliance"].lower <= 0.9 <= found["frame_compliance"].upper


def test_a_single_unloading_says_nothing():
    time = np.linspace(0, 20, 201)
    load = np.interp(time, [0, 10, 20], [0, 5, 0])
    assert laws_of([Recording(time, load, 80.0 * np.sqrt(load))]) == []


def test_zero_point_of_a_sharp_tip():
    time, load = cycles()
    depth = np.where(load > 0, 48.0, 0.0) + 80.0 * np.sqrt(load)
    (row,) = zero_points({"A": [Recording(time, load, depth)]})
    assert (row["condition"], row["number"]) == ("A", 1)
    assert row["estimate"] == pytest.approx(48.0, abs=0.5)


def test_an_interval_holds_its_estimate():
    with pytest.raises(InputError, match="outside"):
        AmplitudeConstraint("thermal_drift", "rate", 1.0, 2.0, 3.0, "a test")


def test_what_may_hide_is_found_to_first_order():
    """A frame planted below what would be named: its amplitude lies in the interval, that of the drift holds zero."""
    observed = recordings(np.random.default_rng(9), lambda c, r: 3.0 * c.protocol.sample_load)
    found = undetected_effects(fitted(problem(observed)), ["frame_compliance", "thermal_drift", "controller_lag"])
    assert set(found) == {"frame_compliance.compliance", "thermal_drift.rate"}
    frame, drift = found["frame_compliance.compliance"], found["thermal_drift.rate"]
    assert frame["lower"] < 3.0 < frame["upper"]
    assert drift["lower"] < 0.0 < drift["upper"]
