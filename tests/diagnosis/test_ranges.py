"""Where a study has effects searched, and with how many draws what they leave is tested; what cannot be is refused."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from closed_forms import TRUTH, ClosedForms
from diagnosis_problem import CONDITIONS, fitted, problem, recordings

from palpate.configuration.study_file import load_study
from palpate.diagnosis.candidates import candidates
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.solver.study_scale import scale_of

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"


def ranged(ranges):
    study = load_study(CHALLENGE)
    return replace(study, diagnosis=study.diagnosis.model_copy(update={"ranges": ranges}))


def amplitudes(mechanism, scale, share):
    """Return a mechanism's parameters at so much of all its ranges."""
    ranges = mechanism.searched(scale).items()
    searched = {name: float(Coordinate.of_amplitude(mechanism, name, r).physical(share)) for name, r in ranges}
    return mechanism.from_search(searched, scale)


def test_a_study_states_where_an_effect_is_searched():
    """A frame that was never corrected, with the load cell's deflection in the depth, may be most of it."""
    frame = {"compliance": [0.0, 40.0]}
    usual, stated = scale_of(ranged({})), scale_of(ranged({"frame_compliance": frame}))
    mechanism = MECHANISMS["frame_compliance"]
    assert amplitudes(mechanism, usual, 1.0)["compliance"] < 0.4 * usual.depth / usual.load
    assert [amplitudes(mechanism, stated, x)["compliance"] for x in (0.0, 1.0)] == [0.0, 40.0]
    yielding = MECHANISMS["plastic_yield"]
    assert amplitudes(yielding, usual, 1.0) == amplitudes(yielding, stated, 1.0)
    candidates(ranged({"frame_compliance": frame}))


def test_a_held_out_test_does_not_decide_what_is_considered():
    study = load_study(CHALLENGE)
    usual = study.conditions[0].protocol
    brief = replace(usual, knot_time=usual.knot_time * 1e-2, sample_time=usual.sample_time * 1e-2)
    held_out = replace(study.conditions[0], name="brief", role="validate", protocol=brief)
    first, last = ((held_out, *study.conditions), (*study.conditions, held_out))
    assert "controller_lag" in candidates(replace(study, conditions=first))
    assert set(candidates(replace(study, conditions=first))) == set(candidates(replace(study, conditions=last)))


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ({"magic": {"amount": [0, 1]}}, "'magic' is not considered"),
        ({"plastic_yield": {"yield_stress": [0.1, 0.2]}}, "yield_stress is not searched; use one of: flow_stress"),
        ({"frame_compliance": {"compliance": [1.0, 1.0]}}, "is no range"),
        ({"plastic_yield": {"flow_stress": [0.0, 0.2]}}, "both positive"),
        ({"plastic_yield": {"flow_stress": [0.1, 1e5]}}, "yield_stress = 100000 GPa is outside its range"),
        ({"friction": {"coefficient": [0.0, 3.0]}}, "ranges.friction: coefficient = 3 is outside its range 0 to 0.5"),
        ({"film_on_substrate": {"thickness": [1, 10]}}, "film_on_substrate: thickness = 1 nm is less than an element"),
        ({"tip_rounding": {"radius": [1, 1e8]}}, "ranges.tip_rounding: radius = 1e+08 nm is larger than the body"),
        ({"controller_lag": {"lag": [0, 500]}}, "lag = 500 s is not shorter than the test"),
    ],
)
def test_ranges_that_mean_nothing_are_refused(ranges, words):
    with pytest.raises(InputError, match=re.escape(words)):
        candidates(ranged(ranges))


def test_ranges_up_to_the_limits_are_taken():
    """Also where what is plausible of the quantity that is not stated, 50 moduli of the film, is beyond its limit."""
    stiff = ranged({"film_on_substrate": {"thickness": [7e3, 1e9]}})
    assert "film_on_substrate" in candidates(replace(stiff, levels=stiff.levels | {"youngs_modulus": (60.0, 70.0)}))
    candidates(ranged({"film_on_substrate": {"substrate_modulus": [0.7, 2000.0]}}))


@pytest.mark.parametrize(("level", "draws", "least"), [(0.01, 299, 300), (0.001, 1000, 3000)])
def test_draws_that_cannot_show_a_misfit_are_refused(level, draws, least):
    """Of three kinds of tests together, draws give p-values of 3 / (draws + 1) at least."""
    study = load_study(CHALLENGE)
    few, enough = (
        replace(study, diagnosis=study.diagnosis.model_copy(update={"significance": level, "bootstrap": count}))
        for count in (draws, least)
    )
    with pytest.raises(InputError, match=f"draw {least} or more"):
        candidates(few)
    candidates(enough)


def test_an_optimum_beyond_the_limit_of_one_parameter_ends_the_search_there():
    task = problem(recordings(np.random.default_rng(11)))
    walled = Coordinates([Coordinate("modulus", 1.05, 1.4, 1.05, np.inf)], {"fluidity": TRUTH["fluidity"]})
    fit = fitted(replace(task, forward=ClosedForms(CONDITIONS, walled)))
    assert fit.z == pytest.approx([0.0], abs=1e-3)
    assert fit.coordinates.at_limit(fit.z).all()


def test_what_cannot_be_negative_counts_by_its_logarithm_and_none_of_it_is_a_number_too():
    fluidity = Coordinate("fluidity", 0.0, 0.03, 0.0, np.inf, logarithmic=True)
    values = np.array([0.0, 1e-4, 0.01, 0.03, 0.1, 0.2, 0.4])
    u = fluidity.scaled(values)
    assert fluidity.physical(u) == pytest.approx(values)
    assert u[[0, 3]] == pytest.approx([0.0, 1.0])
    assert np.diff(u[-3:]) == pytest.approx(np.log(2.0) / np.log(101.0), rel=0.01), "a factor far from none"
    step = 1e-6
    differences = (fluidity.physical(u[1:] + step) - fluidity.physical(u[1:] - step)) / (2.0 * step)
    assert [fluidity.slope(x) for x in u[1:]] == pytest.approx(differences, rel=1e-6)
