"""The search among explanations, with fits that are given."""

from types import SimpleNamespace

import numpy as np
import pytest
from test_diagnosis import fitted, problem, recordings

from palpate.diagnosis.diagnose import _refine_best, _sharpened
from palpate.diagnosis.search import Candidate
from palpate.diagnosis.standing import likeliest_of_each, not_told_from_none

LEVEL = 0.01


def candidate(key, evidence, p_value=0.5, lacks=0.0, occam=0.0):
    fit = SimpleNamespace(explanation=(key,), log_evidence=evidence, log_likelihood=evidence + occam, lacks=lacks)
    return Candidate(fit, p_value, confirmed=True)


def stand(found, *turned_out):
    """Return which keys stand of `found`, best first, where those that `turned_out` otherwise did so by sharpening."""
    asked, better = [], {candidate.fit.explanation: candidate for candidate in turned_out}

    def sharpened(candidate):
        asked.append(candidate)
        return better.get(candidate.fit.explanation, candidate)

    tried, standing = _sharpened(
        SimpleNamespace(sharpened=sharpened, lacking=lambda fit: fit.lacks), found, found, LEVEL
    )
    evidence = [each.fit.log_evidence for each in tried]
    assert len(tried) == len(found)
    assert evidence == sorted(evidence, reverse=True)
    assert len(asked) == len(set(asked)), "once is enough"
    stand.asked = {key for each in asked for key in each.fit.explanation}
    return [key for each in standing for key in each.fit.explanation]


def test_what_stands_is_listed_best_first():
    """Answer and curves rest on the first of the list."""
    found = [candidate("friction", 10.0), candidate("tip_angle", 9.0)]
    assert stand(found, candidate("friction", 8.0)) == ["tip_angle", "friction"]


def test_one_that_turns_out_less_likely_does_not_stand_alone():
    """The second was beyond the likelihood ratio of a hundred of what the first had seemed; so was the third."""
    found = [candidate("friction", 15.0), candidate("tip_angle", 9.0), candidate("adhesion", 4.0)]
    better = candidate("friction", 5.0), candidate("tip_angle", 6.0)
    assert stand(found, *better) == ["tip_angle", "friction", "adhesion"]


def test_another_may_stand_in_place_of_one_that_turns_out_to_leave_more_than_noise():
    found = [candidate("friction", 10.0), candidate("tip_angle", 4.0)]
    assert stand(found, candidate("friction", 6.0, p_value=0.001)) == ["tip_angle"]
    assert stand(found, candidate("friction", 9.0, p_value=0.001)) == []


def test_one_that_fails_by_little_is_judged_by_its_own_slopes():
    found = [candidate("tip_rounding", 83.0, 0.008, lacks=2.0), candidate("zero_offset", 80.5)]
    better = candidate("tip_rounding", 88.4, 0.9)
    assert stand(found, better, candidate("zero_offset", 83.5)) == ["tip_rounding"]
    assert stand(found[:1], better) == ["tip_rounding"]
    assert stand([candidate("tip_rounding", 83.0, 0.001, lacks=100.0)], better) == []
    assert stand.asked == set(), "no slopes make up for that much"


def test_the_instruments_effects_are_compared_with_the_bodys_by_the_same_slopes():
    found = [candidate("tip_rounding", 80.5), candidate("zero_offset", 76.3)]
    better = candidate("tip_rounding", 81.0), candidate("zero_offset", 77.5)
    assert stand(found, *better) == ["tip_rounding", "zero_offset"]
    assert stand([candidate("thermal_drift", 80.5), candidate("zero_offset", 76.3)]) == ["thermal_drift", "zero_offset"]
    assert stand.asked == set(), "among themselves, the base model's slopes do"


def test_what_fits_as_well_stands_though_it_could_have_explained_much_else():
    """A thick film on a soft body gives way in proportion to the load, as a frame does."""
    frame = candidate("frame_compliance", 80.0, occam=4.0)
    assert stand([frame, candidate("film_on_substrate", 72.0, occam=11.0)]) == ["frame_compliance", "film_on_substrate"]
    assert stand([frame, candidate("film_on_substrate", 72.0, occam=6.0)]) == ["frame_compliance"]
    assert stand([frame, candidate("film_on_substrate", 72.0, p_value=0.002, occam=11.0)]) == ["frame_compliance"]


def refined(promises, proves):
    """Return which keys go to the forward model, by what the surrogates promise and what it proves, if anything."""
    fits = [
        SimpleNamespace(explanation=(key,), promise=promise, log_evidence=promise, misfit=1.0, residual=np.zeros(10))
        for key, promise in promises.items()
    ]
    asked = []

    def refined(fit, least):
        asked.append(fit.explanation[0])
        return candidate(*fit.explanation, *proves.get(fit.explanation[0], (fit.promise, 0.0)))

    found = _refine_best(SimpleNamespace(refined=refined), fits, 8, LEVEL, lambda said: None)
    assert len(found) == len(fits)
    return asked


def test_a_rival_is_not_left_out_because_another_promised_too_much():
    """A frame beside a film that is hard to learn: it promised far less than the film, yet more than that proved."""
    promises = {"film_on_substrate": 300.0, "frame_compliance": 105.0, "friction": 80.0}
    assert refined(promises, {"film_on_substrate": (100.0, 0.5), "frame_compliance": (104.0, 0.4)}) == [
        "film_on_substrate",
        "frame_compliance",
    ]


def test_what_falls_far_behind_is_left_to_the_surrogates():
    promises = {"tip_angle": 100.0, "tip_rounding": 90.0, "friction": 80.0, "adhesion": 70.0, "thermal_drift": 50.0}
    assert refined(promises, {}) == ["tip_angle", "tip_rounding", "friction", "adhesion"]
    assert refined(promises, {"tip_angle": (100.0, 0.5)}) == ["tip_angle"], "it would not stand beside it"


@pytest.mark.parametrize(("mean", "found"), [(0.0, ["thermal_drift"]), (0.6, [])])
def test_an_effect_that_differs_from_test_to_test_about_none_is_not_told_from_none(mean, found):
    own = dict(zip("abcd", (0.2, -0.2, 0.2, -0.2), strict=True))
    observed = recordings(np.random.default_rng(5), lambda c, r: (mean + own[c.name]) * c.protocol.sample_time)
    assert not_told_from_none(fitted(problem(observed), ("thermal_drift",))) == found


def test_a_set_that_was_tried_again_is_listed_once():
    stopped, found, other = candidate("friction", 5.0), candidate("friction", 9.0), candidate("adhesion", 7.0)
    assert likeliest_of_each([stopped, other, found]) == [found, other]
