"""Effects that vanish, bodies that are impossible under one condition alone, amplitudes elsewhere than at the fit."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, fitted, problem, recordings

from palpate.configuration.study_file import study_from
from palpate.data.observation import Observation
from palpate.diagnosis.detect import between_replicates, examine
from palpate.diagnosis.screen import Screen
from palpate.inference.amplitude import Amplitude
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.models.finite_elements import FiniteElements
from palpate.observables import OBSERVABLES, Quantity

ELASTIC = {
    "study": "s",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [1.0, 4.0, 16.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "kinematics": "small",
    "points": 12,
}
TRAPEZOID = {"loading_time": 10, "hold_time": 0, "unloading_time": 10}


def test_a_parameter_without_an_effect_hides_no_sample():
    """Its slope is zero: an arbitrary direction in its place would take one sample out of every test."""
    fit = fitted(problem(recordings(np.random.default_rng(11))))
    wider = replace(fit, z=np.append(fit.z, 0.5), tangent=np.column_stack([fit.tangent, np.zeros(len(fit.residual))]))
    assert wider.tangent_space.shape == fit.tangent_space.shape
    outlier = np.zeros(len(fit.residual))
    outlier[2] = 1.0
    assert wider.off_tangent(outlier) == pytest.approx(fit.off_tangent(outlier), abs=1e-9)
    found = [examine(each, Screen.of(fit, RECORD_ONLY), np.random.default_rng(1), 400, 0.01) for each in (fit, wider)]
    assert found[0] == found[1]


def test_replicates_are_judged_by_the_noise_at_the_present_amplitudes():
    """A noise that was fitted with others along the way has another likelihood."""
    fit = fitted(problem(recordings(np.random.default_rng(11))))
    stale = replace(fit.errors.noise, log_likelihood=fit.errors.noise.log_likelihood - 20.0)
    moved = replace(fit, errors=replace(fit.errors, noise=stale))
    assert between_replicates(moved, RECORD_ONLY, 0.01) == between_replicates(fit, RECORD_ONLY, 0.01)


def test_a_body_that_is_impossible_under_one_condition_is_simulated_under_the_others():
    """The controller's lag is longer than the second test."""
    tests = [{"name": "A", "max_load": 1.0, **TRAPEZOID}, {"name": "B", "max_load": 1.0, "loading_time": 0.5,
             "unloading_time": 0.5, "role": "validate"}]  # fmt: skip
    study = study_from(ELASTIC | {"conditions": tests}, "study.yaml")
    model = FiniteElements.of(study, ["A", "B"])
    scale = Problem.of(study, {}).scale
    lagging = model.joined([MECHANISMS["controller_lag"]], scale)
    u = np.append(0.5, float(lagging.coordinates.free[1].scaled(2.0)))
    assert list(lagging.body.possible(u)) == ["A"]


def test_what_an_offset_adds_to_a_load_is_that_of_the_material_that_was_found():
    """The load of an elastic body is in proportion to its modulus, and so is what an offset of the depth adds."""
    test = {"name": "D", "drive": "displacement", "max_displacement": 500.0, **TRAPEZOID}
    study = study_from(ELASTIC | {"conditions": [test]}, "study.yaml")
    time = study.conditions[0].protocol.sample_time
    load = np.linspace(0.1, 1.0, len(time))
    observed = {"D": Observation(time, np.tile(load, (2, 1)), "calibrate", Quantity(OBSERVABLES["load"], -500.0, -2.0))}
    task, offset = Problem.of(study, observed), Amplitude("zero_offset", "offset")
    moduli = (1.0, 4.0)
    places = [task.forward.coordinates.scaled({"youngs_modulus": modulus}) for modulus in moduli]
    soft, stiff = (replace(task, at=place).unit_effects(offset) for place in places)
    assert stiff == pytest.approx(4.0 * soft, rel=1e-3, abs=1e-3 * np.abs(stiff).max())
