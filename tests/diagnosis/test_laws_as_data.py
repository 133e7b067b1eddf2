"""Exact laws as data: they move and narrow amplitudes, pay in the evidence, and show themselves where they disagree."""

from dataclasses import replace

import numpy as np
import pytest
from closed_forms import TRUTH
from diagnosis_problem import RECORD_ONLY, STUDY, problem, recordings
from scipy.integrate import quad
from scipy.stats import norm

from palpate.classical.reference_sample import NORMAL_95
from palpate.diagnosis import undetected
from palpate.diagnosis.constraints import contradicted
from palpate.diagnosis.screen import Screen
from palpate.diagnosis.search import Search
from palpate.diagnosis.undetected import joint_intervals, undetected_effects, wide_intervals
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.posterior import posterior_draws
from palpate.mechanisms import MECHANISMS

FRAME = ("frame_compliance",)
COMPLIANCE = 6.0


def law(estimate, half, lower=None):
    return AmplitudeConstraint(
        "frame_compliance", "compliance", estimate, estimate - half if lower is None else lower, estimate + half, "-"
    )


@pytest.fixture(scope="module")
def yielding():
    """Recordings with a frame left in."""
    return problem(recordings(np.random.default_rng(12), lambda c, r: COMPLIANCE * c.protocol.sample_load))


def fitted(task, explanation=FRAME, laws=()):
    search = Search(STUDY, task, [], np.random.default_rng(0), TRUTH, lambda base: laws)
    start = np.full(len(task.coordinates(explanation).free), 0.5)
    return search.fitted(explanation, [start], task.mean)


def value(fit):
    return fit.problem.amplitudes(fit.explanation, fit.z)["frame_compliance"]["compliance"]


def deviation(fit):
    low, high = (fit.problem.amplitudes(FRAME, np.append(fit.z[:-1], end))["frame_compliance"] for end in (0.0, 1.0))
    return (high["compliance"] - low["compliance"]) * float(np.sqrt(fit.posterior[-1, -1]))


def test_a_law_narrows_the_amplitude_as_independent_data_do(yielding):
    alone = fitted(yielding)
    sigma = deviation(alone)
    both = fitted(yielding, laws=[law(value(alone) + sigma, 1.96 * sigma)])
    assert value(both) == pytest.approx(value(alone) + 0.5 * sigma, abs=0.1 * sigma)
    assert deviation(both) == pytest.approx(sigma / np.sqrt(2.0), rel=0.05)


def test_the_draws_follow_the_law(yielding):
    fit = fitted(yielding, laws=[law(COMPLIANCE, 0.1 * deviation(fitted(yielding)))])
    draws = posterior_draws(fit)
    values = [yielding.amplitudes(FRAME, z)["frame_compliance"]["compliance"] for z in draws]
    assert np.median(values) == pytest.approx(COMPLIANCE, abs=0.1 * deviation(fitted(yielding)))


def test_a_bound_says_nothing_below_itself(yielding):
    alone = fitted(yielding)
    sigma = deviation(alone)
    loose, tight = (fitted(yielding, laws=[law(value(alone) + k * sigma, 0.1 * sigma, lower=-np.inf)]) for k in (3, -3))
    assert value(loose) == pytest.approx(value(alone), abs=0.01 * sigma)
    assert value(tight) == pytest.approx(value(alone) - 3 * sigma, abs=0.2 * sigma)


def test_who_leaves_the_frame_out_pays_in_the_evidence(yielding):
    said = [law(COMPLIANCE, 1.0)]
    gain = [fitted(yielding, e, said).log_evidence - fitted(yielding, e).log_evidence for e in ((), FRAME)]
    assert gain[0] == pytest.approx(-0.5 * (1.96 * COMPLIANCE) ** 2, rel=1e-3)
    assert gain[1] > -3.0


@pytest.mark.parametrize("sigma", [0.001, 0.01, 0.1])
def test_an_amplitude_that_is_left_out_counts_as_one_of_its_background(yielding, sigma):
    """The likelihood of the law is its mean over a Gaussian amplitude of the background's standard deviation."""
    rate, background = 0.02, MECHANISMS["thermal_drift"].background
    drift = AmplitudeConstraint("thermal_drift", "rate", rate, rate - NORMAL_95 * sigma, rate + NORMAL_95 * sigma, "-")

    def joint(z):
        return norm.pdf(z) * np.exp(-0.5 * ((background * z - rate) / sigma) ** 2)

    mean = quad(joint, -10.0, 10.0, points=[rate / background], epsabs=1e-300)[0]
    gain = fitted(yielding, (), [drift]).log_likelihood - fitted(yielding, ()).log_likelihood
    assert gain == pytest.approx(np.log(mean), rel=1e-6)


def test_a_law_that_disagrees_with_the_curves_is_contradicted_though_it_took_part(yielding):
    sigma = deviation(fitted(yielding))
    wrong, right = law(COMPLIANCE + 12 * sigma, sigma), law(COMPLIANCE, sigma)
    assert contradicted(fitted(yielding, laws=[wrong]), [wrong]) == [wrong]
    assert contradicted(fitted(yielding, laws=[right]), [right]) == []


def test_a_law_fixes_what_may_hide(yielding):
    free, held = (undetected_effects(fitted(yielding, (), laws), FRAME) for laws in ((), [law(COMPLIANCE, 0.01)]))
    name = "frame_compliance.compliance"
    assert free[name]["lower"] < COMPLIANCE < free[name]["upper"]
    assert held[name]["estimate"] == pytest.approx(COMPLIANCE, abs=0.01)
    assert held[name]["upper"] - held[name]["lower"] == pytest.approx(0.02, rel=0.1)


def test_amplitudes_are_less_certain_when_more_may_act(yielding):
    fit = fitted(yielding)
    found = joint_intervals(fit, Screen.of(fit, RECORD_ONLY))
    frame = found["frame_compliance.compliance"]
    assert frame["lower"] < COMPLIANCE < frame["upper"]
    assert frame["upper"] - frame["lower"] > 2 * 1.96 * deviation(fit)
    assert 0.0 < abs(frame["correlation"]) < 1.0
    assert set(found) == {"frame_compliance.compliance", "zero_offset.offset", "thermal_drift.rate"}


def test_what_is_open_is_said_with_the_test_that_would_fix_it(yielding, monkeypatch):
    free, held = fitted(yielding), fitted(yielding, laws=[law(COMPLIANCE, 0.001)])
    screen = Screen.of(free, RECORD_ONLY)
    frame = joint_intervals(free, screen)["frame_compliance.compliance"]
    largest = max(condition.protocol.max_load for condition in yielding.conditions)
    share = 0.5 * (frame["upper"] - frame["lower"]) * largest / np.abs(yielding.mean).max()
    monkeypatch.setattr(undetected, "COARSE", 0.5 * share)
    assert any(
        "unloadings from loads that span" in line for line in wide_intervals(free, joint_intervals(free, screen))
    )
    assert not any(
        "unloadings from loads that span" in line for line in wide_intervals(held, joint_intervals(held, screen))
    )


def test_without_laws_nothing_changes(yielding):
    with_none, without = fitted(yielding, laws=[]), fitted(yielding)
    assert with_none.log_evidence == without.log_evidence
    assert with_none.z == pytest.approx(without.z, abs=0.0)


def test_a_law_is_silent_where_a_mechanism_breaks_what_it_assumes(yielding):
    """Tops of unloadings see a frame in a drift, too: an explanation with one neither obeys nor contradicts them."""
    wrong = law(3.0 * COMPLIANCE, 0.05 * COMPLIANCE)
    assert contradicted(fitted(yielding, laws=[wrong]), [wrong]) == [wrong]
    silent = replace(wrong, void_with=("thermal_drift",))
    drifting = (*FRAME, "thermal_drift")
    free, held = fitted(yielding, drifting), fitted(yielding, drifting, laws=[silent])
    assert value(held) == pytest.approx(value(free))
    assert held.misfit == pytest.approx(free.misfit)
    assert contradicted(held, [silent]) == []
    assert contradicted(fitted(yielding, laws=[silent]), [silent]) == [silent]
