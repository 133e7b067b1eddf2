"""Uniaxial tests that calibrate beside indentation: what they are worth, and what the law lacks in them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from closed_forms import ClosedForms, cone
from diagnosis_problem import CONDITIONS, SCALE, recordings

from indentation_files.uniaxial_test import UniaxialTest
from palpate.configuration.study_file import load_study
from palpate.data.bulk_tests import BulkTest
from palpate.inference.bulk_likelihood import BulkLikelihood, covariance
from palpate.inference.fitting import Fitter
from palpate.inference.posterior import posterior_draws
from palpate.inference.problem import Problem
from palpate.models.bulk_model import BulkModel
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.models.finite_elements import FiniteElements
from palpate.study.indenter import Indenter
from palpate.study.specification import Specification

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"
TIME = np.linspace(0.0, 60.0, 121)
STRAIN = 0.02 * TIME / 60.0
E = 3.0
FIXED = {"poisson_ratio": 0.34, "steady_exponent": 0.0, "transient_coefficient": 0.0}
FIXED |= {"transient_exponent": 0.0, "retardation_time": 1.0}
FREE = Coordinates(
    [
        Coordinate("youngs_modulus", 2.1, 4.2, 1e-3, np.inf),
        Coordinate("steady_coefficient", 0.0, 0.03, 0.0, np.inf),
    ],
    {},
)


@dataclass(frozen=True, eq=False)
class Body(ClosedForms):
    """The cone of `closed_forms` in terms of a linear Maxwell solid, whose modulus is 3 GPa where theirs is one."""

    coordinates: Coordinates = FREE

    def _curve(self, u, condition):
        own = {"modulus": self.coordinates.named(u)["youngs_modulus"] / E}
        own["fluidity"] = self.coordinates.named(u)["steady_coefficient"]
        depth = cone(condition.protocol, **own)
        compliance = self.amplitudes(u).get("frame_compliance", {"compliance": 0.0})["compliance"]
        depth = depth + compliance * condition.protocol.sample_load
        return depth[self.keep[condition.name]] if self.keep else depth

    def specification(self, u, condition):
        values = {name: self.coordinates.named(u)[name] for name in ("youngs_modulus", "steady_coefficient")}
        mechanisms = self.amplitudes(u)
        tip = Indenter("cone", 70.3)
        return Specification("nonlinear_burgers", FIXED | values, tip, condition.protocol, mechanisms=mechanisms)


def stress_of(modulus=E, fluidity=0.01):
    """Stress of a Maxwell solid under a constant rate of strain, in closed form."""
    rate, relaxation = 0.02 / 60.0, 2.0 / 3.0 * modulus * fluidity
    return modulus * rate / relaxation * (1.0 - np.exp(-relaxation * TIME))


def tension(rng=None, noise=2e-4, stress=None, role="calibrate"):
    stress = stress_of() if stress is None else stress
    rough = 0.0 if rng is None else noise * rng.standard_normal(len(TIME))
    return BulkTest(UniaxialTest(TIME, STRAIN, stress + rough, "tension"), role, "strain")


def problem(observed, *tests, law_error=0.0):
    bulk = BulkModel("nonlinear_burgers", FIXED, tests)
    likelihood = BulkLikelihood.of(bulk, FREE, law_error)
    return Problem(CONDITIONS, observed, Body(CONDITIONS), SCALE, bulk=bulk, bulk_likelihood=likelihood)


def fitted(task, explanation=()):
    start = np.full(len(task.coordinates(explanation).free), 0.5)
    fitter = Fitter(task, 0.01, 0.003)
    base = fitter.base([start[: task.material]])
    return fitter.fitted(explanation, [np.append(base.z, start[task.material :])], base.curve) if explanation else base


def test_a_precise_test_fixes_the_modulus_as_far_as_its_noise_allows():
    """Where indentation tells little, information is sum (d sigma / d theta)^2 / noise^2."""
    rng, noise = np.random.default_rng(1), 2e-4
    observed = recordings(rng, sigma=20.0, site=0.2)
    alone, joint = (fitted(problem(observed, *tests)) for tests in ((), (tension(rng, noise),)))
    slopes = np.column_stack(
        [(stress_of(E + 1e-4) - stress_of(E - 1e-4)) / 2e-4, (stress_of(E, 0.0101) - stress_of(E, 0.0099)) / 2e-4]
    )
    (own,) = joint.problem.bulk.tests
    expected = np.sqrt(np.linalg.inv(slopes.T @ slopes / own.noise**2)[0, 0])
    modulus, draws = FREE.free[0], (posterior_draws(fit)[:, 0] for fit in (alone, joint))
    wide, narrow = (float(np.std(modulus.physical(each))) for each in draws)
    assert narrow == pytest.approx(expected, rel=0.2) and narrow < 0.2 * wide
    assert joint.coordinates.named(joint.z)["youngs_modulus"] == pytest.approx(E, abs=3.0 * expected)


def test_estimates_are_free_of_bias_and_scatter_as_the_posterior_says():
    found = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        fit = fitted(problem(recordings(rng), tension(rng)))
        found.append(
            (fit.z - FREE.scaled({"youngs_modulus": E, "steady_coefficient": 0.01})) / np.sqrt(np.diag(fit.posterior))
        )
    assert np.all(np.abs(np.mean(found, axis=0)) < 3.0 / np.sqrt(12))
    assert 0.4 < np.std(found) < 1.7


def test_tests_that_only_judge_change_nothing():
    observed = recordings(np.random.default_rng(1))
    judged = problem(observed, tension(stress=1.2 * stress_of(), role="validate"))
    assert fitted(judged).z == pytest.approx(fitted(problem(observed)).z, abs=1e-9)
    assert len(judged.bulk_departures((), np.array([0.5, 0.5]))) == 0


@pytest.mark.parametrize(("size", "lowest", "highest"), [(0.0, 0.0, 0.004), (0.03, 0.01, 0.05)])
def test_what_the_law_lacks_is_estimated_from_the_test_alone(size, lowest, highest):
    """A wave of 3 % of the largest stress that no Maxwell solid has; its root mean square is 2 %."""
    stress = stress_of() * (1.0 + size * np.sin(2.0 * np.pi * TIME / 60.0))
    test = tension(np.random.default_rng(0), 5e-5, stress)
    likelihood = BulkLikelihood.of(BulkModel("nonlinear_burgers", FIXED, (test,)), FREE, 0.0025)
    assert lowest <= likelihood.tests[0].share <= highest
    exact = BulkLikelihood.of(BulkModel("nonlinear_burgers", FIXED, (test,)), FREE, 0.0)
    assert exact.tests[0].share == 0.0


def test_a_law_that_lacks_something_leaves_the_modulus_open():
    rng = np.random.default_rng(0)
    wave = stress_of() * (1.0 + 0.03 * np.sin(2.0 * np.pi * TIME / 60.0))
    observed = recordings(rng, sigma=20.0, site=0.2)
    right, wrong = (fitted(problem(observed, tension(rng, 5e-5, s), law_error=0.0025)) for s in (stress_of(), wave))
    spread = [float(np.sqrt(fit.posterior[0, 0])) for fit in (right, wrong)]
    assert spread[1] > 3.0 * spread[0]


def test_the_discrepancy_is_shared_by_neighbours_and_grows_with_the_stress():
    test = tension()
    found = covariance(test, 0.02) - test.noise**2 * np.eye(len(TIME))
    largest = test.response
    assert np.sqrt(np.diag(found)) == pytest.approx(0.02 * largest)
    correlation = found[60, 1:] / (0.02**2 * largest[60] * largest[1:])
    assert correlation[58] > 0.97 and correlation[60] > 0.97 and correlation[0] < 0.01


def test_a_tension_test_tells_a_soft_frame_from_a_soft_material():
    """Loads in one ratio of times alone: the frame adds to the depth what a lower modulus would, nearly."""
    rng = np.random.default_rng(2)
    observed = recordings(rng, effect=lambda c, r: 10.0 * c.protocol.sample_load, sigma=10.0, site=0.03)
    few = {"a": observed["a"], "b": observed["b"]}
    some = tuple(c for c in CONDITIONS if c.name in few)
    spread = []
    for tests in ((), (tension(rng, 1e-4),)):
        task = replace(problem(few, *tests), conditions=some, forward=Body(some))
        fit = fitted(task, ("frame_compliance",))
        place = task.place(("frame_compliance",), "frame_compliance.compliance")
        spread.append(float(np.sqrt(fit.posterior[place, place])))
        value = task.quantity(("frame_compliance",), fit.z, "frame_compliance.compliance")[0]
    assert spread[1] < 0.5 * spread[0]
    assert value == pytest.approx(10.0, abs=25.0 * spread[1] * 10.0)


def test_a_mechanism_that_changes_the_law_changes_it_in_the_bulk():
    """A second Voigt element retards there as well: its coordinate moves the departures."""
    study = load_study(CHALLENGE)
    forward = FiniteElements.of(study, [study.conditions[0].name])
    test = BulkTest(UniaxialTest(TIME, STRAIN, E * STRAIN, "tension"), "calibrate", "strain")
    bulk = BulkModel(study.model, study.fixed, (test,))
    likelihood = BulkLikelihood.of(bulk, forward.coordinates, 0.0)
    task = Problem(study.conditions[:1], {}, forward, SCALE, bulk=bulk, bulk_likelihood=likelihood)
    material = np.full(task.material, 0.5)
    base = task.bulk_departures((), material)
    for key, moves in (("thermal_drift", False), ("second_voigt", True)):
        z = np.append(material, np.full(len(task.coordinates((key,)).free) - task.material, 0.7))
        assert (np.abs(task.bulk_departures((key,), z) - base).max() > 1.0) == moves
