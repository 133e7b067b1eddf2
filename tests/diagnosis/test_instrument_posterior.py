"""Twins in one study are told apart by two on one instrument; the posterior of one is the prior of the other."""

import json

import numpy as np
import pytest
from one_instrument import SHARES, diagnosed

from palpate.configuration.instrument_section import read_prior
from palpate.diagnosis.explanations import Explanations, log_prior

TRUTHS = [
    {"compliance": 20.0},
    {"on_film": True},
    {"compliance": 20.0, "on_film": True},
    {"radius": 30.0, "on_film": True},
]


def prior_of(found, shares=SHARES):
    return read_prior(json.loads(json.dumps({"study": "bulk", **found})), shares)


def acting(truth):
    names = {"compliance": "frame_compliance", "radius": "tip_rounding", "on_film": "film_on_substrate"}
    return frozenset(names[each] for each in truth)


@pytest.mark.parametrize("truth", TRUTHS)
def test_frame_and_film_are_told_apart_by_two_studies(truth):
    """The film's substrate and the frame add in proportion to the load; the bulk solid has no film."""
    bulk, found = diagnosed(4.0, 1, **{name: value for name, value in truth.items() if name != "on_film"})
    assert bulk.verdict == ("adequate" if truth.keys() == {"on_film"} else "identified")
    alone, _ = diagnosed(2.0, 2, film_may_act=True, **truth)
    joint, _ = diagnosed(2.0, 2, film_may_act=True, prior=prior_of(found), **truth)
    assert alone.verdict == "ambiguous" or not alone.all_sets.get(acting(truth), 0.0) > 0.5
    assert joint.verdict == "identified" and frozenset(joint.best.fit.explanation) == acting(truth)


def test_the_posterior_after_both_studies_is_narrower_and_holds_the_truth():
    _, found = diagnosed(4.0, 1, compliance=20.0)
    _, both = diagnosed(2.0, 2, compliance=20.0, prior=prior_of(found))
    first, second = (each["sets"][0]["estimates"]["frame_compliance.compliance"] for each in (found, both))
    assert second["upper"] - second["lower"] < first["upper"] - first["lower"]
    assert second["lower"] < 20.0 < second["upper"]
    assert both["inclusion"]["frame_compliance"] > 0.99


def test_a_study_that_says_nothing_returns_its_prior():
    """Under a hundredth of the load a frame shows nothing: probabilities and amplitudes are those of the prior."""
    _, found = diagnosed(4.0, 1, compliance=20.0)
    _, after = diagnosed(0.04, 3, compliance=20.0, prior=prior_of(found))
    before, (now, *_) = found["sets"][0], after["sets"]
    assert now["mechanisms"] == before["mechanisms"] == ["frame_compliance"]
    assert now["probability"] == pytest.approx(before["probability"], abs=0.05)
    deviation = np.sqrt(before["covariance"][0][0])
    assert now["mean"] == pytest.approx(before["mean"], abs=0.3 * deviation)
    assert np.sqrt(now["covariance"][0][0]) == pytest.approx(deviation, rel=0.15)
    ranges = [[(row["lower"], row["upper"]) for row in each["quantities"]] for each in (found, after)]
    assert ranges[0] == ranges[1], "the coordinates are the same"


def test_a_set_that_was_not_fitted_has_amplitudes_to_first_order():
    outcome, found = diagnosed(4.0, 1)
    fitted = {frozenset(members) for members in outcome.sets.fitted}
    (frame,) = (row for row in found["sets"] if row["mechanisms"] == ["frame_compliance"])
    assert frozenset({"frame_compliance"}) not in fitted
    estimate = frame["estimates"]["frame_compliance.compliance"]
    assert estimate["lower"] < 0.0 < estimate["upper"] < 10.0


def test_sets_of_shared_effects_have_the_probability_of_the_earlier_study():
    _, found = diagnosed(4.0, 1, compliance=20.0)
    prior = prior_of(found)
    sets = Explanations(5, 1.0, prior)
    frame, film = "frame_compliance", "film_on_substrate"
    by_set = prior.probabilities[frozenset({frame})]
    assert sets._log_prior(frozenset({frame})) == pytest.approx(np.log(by_set) + log_prior(0, 3))
    assert sets._log_prior(frozenset({frame, film})) == pytest.approx(np.log(by_set) + log_prior(1, 3))
