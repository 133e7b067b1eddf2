"""The tests that are proposed next: their load histories, and what stays behind when the tip is exchanged."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, fitted, problem, recordings

from palpate.configuration.study_file import load_study
from palpate.diagnosis.next_test import Account, error_of_means, feasible, of_test
from palpate.diagnosis.undetected import UndetectedEffect, largest_undetected, undetected_effects
from palpate.inference.amplitude import Amplitude
from palpate.models.finite_elements import FiniteElements
from palpate.solver.simulation import simulate, specification_from
from palpate.study.indenter import Indenter

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"
SPEC = {
    "material": {"model": "elastic", "youngs_modulus": 3.28, "poisson_ratio": 0.34},
    "indenter": {"shape": "cone", "half_angle": 70.3, "friction": 0.1},
    "protocol": {"max_load": 1.0, "loading_time": 10.0, "unloading_time": 10.0, "points": 8},
    "kinematics": "small",
}

DRIFT = ("thermal_drift",)


def proposed(indenter):
    return list(feasible(1.0, 10.0, indenter))


def test_every_test_can_be_told_apart_by_its_words():
    tests = proposed(Indenter("cone", 70.3))
    assert len({test.phrase for test in tests}) == len(tests)
    assert all(test.protocol.max_load == pytest.approx(test.settings["max_load"]) for test in tests)


def test_another_tip_takes_the_old_ones_rounding_along_and_nothing_else():
    (other,) = [test for test in proposed(Indenter("cone", 70.3, friction=0.1)) if test.indenter]
    assert other.phrase.endswith("with a sphere of 10 um")
    effects = {"tip_rounding": {"radius": 200.0}, "zero_offset": {"offset": 12.0}}
    specification = of_test(specification_from(SPEC | {"mechanisms": effects}), other)
    assert specification.mechanisms == {"zero_offset": {"offset": 12.0}}
    assert (specification.indenter.shape, specification.indenter.radius) == ("sphere", 10_000.0)
    assert specification.indenter.friction == 0.1
    assert simulate(specification).status == "ok"


def test_a_pyramid_is_exchanged_for_a_sphere():
    (other,) = [test for test in proposed(Indenter.from_mapping({"shape": "berkovich"})) if test.indenter]
    assert other.phrase.endswith("with a sphere of 10 um")
    assert other.indenter == Indenter("sphere", radius=1e4)


def test_a_sphere_is_exchanged_for_a_sharp_tip():
    (other,) = [test for test in proposed(Indenter("sphere", radius=1e4)) if test.indenter]
    assert other.phrase.endswith("with a Berkovich tip")
    assert other.settings["half_angle"] == 70.3


def test_where_a_study_has_several_tips_the_next_test_is_with_one_of_them():
    tests = list(feasible(1.0, 10.0, Indenter("cone", 70.3), {"ball": 5.0}))
    assert not any(test.indenter for test in tests)
    assert [test.settings["max_load"] for test in tests if test.condition.tip == "ball"] == [0.5, 15.0]


def next_hold():
    """Return the test with a long hold, as a condition, and a curve under it."""
    (hold,) = [test for test in proposed(Indenter("cone", 70.3)) if test.phrase.startswith("a hold of 100 s at 1 mN")]
    return hold.condition, 500.0 * np.sqrt(hold.protocol.sample_load)


def test_a_drift_has_another_rate_in_the_next_test():
    """Rates scatter by 0.3 nm/s, so the mean of three recordings of two minutes is open by 20 nm, and not by 2."""
    rates = np.random.default_rng(3).normal(0.3, 0.2, size=4 * 3)
    drifting = recordings(
        np.random.default_rng(1), lambda c, r: rates["abcd".index(c.name) * 3 + r] * c.protocol.sample_time
    )
    condition, curve = next_hold()
    covariance = error_of_means(load_study(CHALLENGE), fitted(problem(drifting), DRIFT), condition, curve)
    end = condition.protocol.sample_time[-1]
    assert np.sqrt(covariance[-1, -1]) == pytest.approx(0.3 * end / np.sqrt(3), rel=0.1)


def test_the_effect_that_could_hide_most_lies_at_an_end_of_its_interval_and_moves_the_material_along():
    """No other material leaves less beside an effect of that size."""
    fit = fitted(problem(recordings(np.random.default_rng(2), replicates=2, sigma=20.0)))
    hidden = largest_undetected(fit, RECORD_ONLY)
    intervals = undetected_effects(fit, RECORD_ONLY)
    assert hidden.value in (intervals[str(hidden.amplitude)]["lower"], intervals[str(hidden.amplitude)]["upper"])
    column = fit.problem.unit_effects(hidden.amplitude)
    assert hidden.adds == pytest.approx(abs(hidden.value) * np.abs(column).max())
    prior = np.sqrt(12.0) * np.eye(len(fit.z))
    rows = np.vstack([fit.whiten(fit.tangent), prior])
    aims = np.append(fit.whiten(fit.residual - hidden.value * column), np.zeros(len(fit.z)))
    assert hidden.change == pytest.approx(np.linalg.lstsq(rows, aims)[0], rel=1e-6)


def test_no_effect_hides_in_precise_recordings():
    fit = fitted(problem(recordings(np.random.default_rng(2), sigma=0.1, memory=0.0, site=1e-4)))
    assert largest_undetected(fit, RECORD_ONLY) is None


def test_a_test_is_simulated_with_the_effect_that_could_hide():
    study = load_study(CHALLENGE)
    model = FiniteElements.of(study, [study.conditions[0].name])
    middle = np.full(len(model.coordinates.free), 0.5)
    fit = SimpleNamespace(model=model, z=middle, coordinates=model.coordinates, explanation=())
    change = 0.1 * np.eye(len(middle))[0]
    base = Account.of(fit, np.tile(middle, (20, 1)))
    both = base.with_hidden(UndetectedEffect(Amplitude("thermal_drift", "rate"), 0.4, change, 40.0))
    assert (base.name, both.name) == ("base model", "base model with thermal_drift")
    test = proposed(study.indenter)[0]
    there = both.specification(middle, test)
    assert there.mechanisms == {"thermal_drift": {"rate": 0.4}}
    moved = model.specification(middle + change, test.condition).specimen.coefficients
    assert there.specimen.coefficients == pytest.approx(moved)
    assert base.specification(middle, test).specimen.coefficients != pytest.approx(moved)
