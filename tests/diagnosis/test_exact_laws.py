"""Laws of a solid that creeps: what it shows by itself is taken off, and it is simulated only where it must be."""

from types import SimpleNamespace

import numpy as np
import pytest
from creep_holds import held_low
from load_cycles import cycles

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.configuration.settings import DiagnosisSettings
from palpate.diagnosis import constraints
from palpate.diagnosis.constraints import MOST_POINTS, ExactLaws, laws_of
from palpate.materials import law_of
from palpate.study.protocol import trapezoid

CREEP = 0.28
TESTS = {"a": [Recording(*held_low(0.3, CREEP, seed)) for seed in (0, 5)], "b": [Recording(*held_low(0.3, CREEP, 9))]}
BASE = SimpleNamespace(problem=SimpleNamespace(conditions=(SimpleNamespace(name="a", tip=""),)))


LAWS = {
    "elastic": {},
    "nonlinear_burgers": {
        "steady_coefficient": 0.09, "steady_exponent": 0.2, "transient_coefficient": 0.0, "transient_exponent": 0.5,
        "retardation_time": 1.0,
    },
    "eyring": {"reference_rate": 1e-3, "eyring_stress": 0.01, "pressure_coefficient": 0.1},
    "retardation_spectrum": {"spectrum_coefficient": 0.05, "spectrum_exponent": 0.1},
}  # fmt: skip


def study(law):
    values = {"youngs_modulus": 3.0, "poisson_ratio": 0.35} | LAWS[law]
    specimen = SimpleNamespace(coefficients=law_of(law).coefficients(values))
    return SimpleNamespace(
        levels={},
        conditions=[None],
        diagnosis=DiagnosisSettings(),
        specification=lambda *_: SimpleNamespace(specimen=specimen),
    )


def test_a_solid_that_does_not_creep_is_not_simulated(monkeypatch):
    monkeypatch.setattr(constraints, "undisturbed", None)
    (law,) = ExactLaws(study("elastic"), TESTS).beside(BASE)
    assert (law.estimate, law.upper) == pytest.approx((0.58, 0.6), abs=0.03)


@pytest.mark.parametrize("law", ["nonlinear_burgers", "eyring", "retardation_spectrum"])
def test_the_creep_of_the_base_model_is_taken_off(law, monkeypatch):
    alone = {"a": Recording(*held_low(0.0, CREEP))}
    monkeypatch.setattr(constraints, "undisturbed", lambda *_: alone)
    found = ExactLaws(study(law), TESTS)
    (law,) = found.beside(BASE)
    assert law.estimate == pytest.approx(0.3, abs=0.02)
    each = found.of_each()
    assert [len(laws) for laws in each["a"]] == [1, 1]
    assert [law.lower for (law,) in each["b"]] == [-np.inf], "held out, not simulated: nothing but the bound"


def test_a_bound_needs_no_simulation(monkeypatch):
    monkeypatch.setattr(constraints, "undisturbed", None)
    time, load, depth = held_low(0.3, CREEP)
    short = time < 32.0
    tests = {"a": [Recording(time[short], load[short], depth[short])]}
    (law,) = ExactLaws(study("nonlinear_burgers"), tests).beside(BASE)
    assert law.lower == -np.inf


def test_what_creep_does_to_the_tops_of_unloadings_is_no_frame():
    """Depth that goes on growing as the load falls makes the tops steep: a frame of -2 nm/mN."""
    time, load = cycles()
    depth = 80.0 * np.sqrt(load) + 0.02 * np.random.default_rng(0).standard_normal(len(time))
    (naive,) = laws_of([Recording(time, load, depth - 2.0 * load)])
    assert naive.upper < 0.0
    (law,) = laws_of([Recording(time, load, depth - 2.0 * load)], [Recording(time, load, depth - 1.5 * load)])
    assert law.lower <= 0.0 <= law.upper


def test_the_simulation_is_sampled_as_the_recording():
    condition = Condition("a", "calibrate", trapezoid(1.0, 10.0, 5.0, 10.0, points=30))
    time = np.sort(np.random.default_rng(0).uniform(0.0, 26.0, 2000))
    recording = Recording(time, time, time)
    sampled = constraints._sampled_as(condition, recording).protocol.sample_time
    assert len(sampled) == MOST_POINTS
    assert np.isin(sampled, time).all()
    assert sampled[-1] <= 25.0
