"""Verdicts of whole diagnoses, on closed forms."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from closed_forms import TRUTH, ClosedForms, rounded
from diagnosis_problem import CONDITIONS, RECORD_ONLY, STUDY, fitted, problem, recordings, search_of
from test_search import named

from palpate.diagnosis.diagnose import diagnose, zero_on_average
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.search import Search
from palpate.errors import PalpateError


@pytest.mark.parametrize(("mean", "found"), [(0.0, ["thermal_drift"]), (0.6, [])])
def test_an_effect_that_differs_from_test_to_test_about_none_is_not_told_from_none(mean, found):
    own = dict(zip("abcd", (0.2, -0.2, 0.2, -0.2), strict=True))
    observed = recordings(np.random.default_rng(5), lambda c, r: (mean + own[c.name]) * c.protocol.sample_time)
    assert zero_on_average(fitted(problem(observed), ("thermal_drift",))) == found


def frame(condition, replicate):
    return 8.0 * condition.protocol.sample_load


def diagnosed(task, keys=RECORD_ONLY):
    return diagnose(search_of(task, keys), lambda said: None)


def test_recordings_without_an_effect_are_adequate():
    found = diagnosed(problem(recordings(np.random.default_rng(11))))
    assert (found.verdict, found.accepted, found.law_within_tolerance) == ("adequate", [], True)
    assert found.all_sets[frozenset()] > 0.5


def test_what_one_mechanism_explains_and_no_other_is_identified():
    found = diagnosed(problem(recordings(np.random.default_rng(5), frame)))
    assert (found.verdict, named(found.accepted)) == ("identified", ["frame_compliance"])
    assert found.family_inclusion["frame"] > 0.99 and found.probabilities[0] > 0.9
    evidence = [each.fit.log_evidence for each in found.tried]
    assert evidence == sorted(evidence, reverse=True)
    assert found.base.fit.explanation in [each.fit.explanation for each in found.tried]


def test_a_single_explanation_is_suspected_where_the_noise_is_assumed():
    found = diagnosed(problem(recordings(np.random.default_rng(5), lambda c, r: 6.0 * frame(c, r), replicates=1)))
    assert (found.verdict, named(found.accepted)) == ("suspected", ["frame_compliance"])


def test_a_single_explanation_of_one_kind_of_test_is_suspected_where_it_acts_on_the_body():
    """What a blunted tip does to one curve, a law that is in no library may do, too."""

    def planted(condition, replicate):
        return rounded(condition.protocol, {"radius": 100.0})

    observed = recordings(np.random.default_rng(4), planted, site=0.002)
    alone = diagnosed(problem(observed, CONDITIONS[2:3], tip_rounding=rounded), ["tip_rounding"])
    every = diagnosed(problem(observed, tip_rounding=rounded), ["tip_rounding"])
    assert (alone.verdict, named(alone.accepted)) == ("suspected", ["tip_rounding"])
    assert (every.verdict, named(every.accepted)) == ("identified", ["tip_rounding"])


def test_a_single_explanation_whose_mean_may_be_none_is_suspected():
    """Drifts that differ from recording to recording, about none: chance may do that, too."""
    own = np.random.default_rng(2).normal(0.0, 0.3, (4, 3))
    own -= own.mean(axis=1, keepdims=True)
    rates = dict(zip("abcd", own, strict=True))
    observed = recordings(np.random.default_rng(5), lambda c, r: rates[c.name][r] * c.protocol.sample_time)
    found = diagnosed(problem(observed))
    assert (found.verdict, named(found.accepted)) == ("suspected", ["thermal_drift"])


def test_an_effect_in_no_library_stays_unexplained():
    wave = lambda c, r: 12.0 * np.sin(2 * np.pi * c.protocol.sample_time / 9.0)  # noqa: E731
    found = diagnosed(problem(recordings(np.random.default_rng(7), wave)))
    assert (found.verdict, found.accepted, found.probabilities) == ("unexplained", [], [])
    assert {len(each.fit.explanation) for each in found.tried} == {0, 1, 2}
    closest = found.tried[0].fit.with_remainder
    assert closest.misfit_ratio == pytest.approx(1.0), "a discrepancy is what makes chi-square its degrees of freedom"
    left = [np.linalg.norm(each.fit.residual) for each in found.tried if len(each.fit.z) == len(closest.z)]
    assert np.linalg.norm(closest.residual) < 1.02 * min(left), "large beside the noise, what is left decides"


def test_two_effects_are_found_together():
    both = lambda c, r: frame(c, r) + (0.3 + 0.05 * r) * c.protocol.sample_time  # noqa: E731
    found = diagnosed(problem(recordings(np.random.default_rng(5), both)))
    assert found.verdict == "identified"
    assert set(found.accepted[0].fit.explanation) == {"frame_compliance", "thermal_drift"}


class Failing(Search):
    """In which the forward model cannot follow a zero offset."""

    def joined(self, fit, key, stop):
        if key == "zero_offset":
            raise PalpateError("lost contact")
        return super().joined(fit, key, stop)


def test_what_is_found_does_not_depend_on_the_number_of_threads():
    """Fits begun early that nobody asks for later leave no trace, and errors come where they would have come."""

    def told(threads):
        both = lambda c, r: frame(c, r) + 3.0  # noqa: E731
        task, policy, lines = problem(recordings(np.random.default_rng(5), both)), SearchPolicy(threads=threads), []
        search = Failing(STUDY, task, RECORD_ONLY, np.random.default_rng(0), TRUTH, policy=policy)
        found = diagnose(search, lines.append)
        return lines, found.failed, [(each.fit.explanation, each.fit.z.tolist(), each.p_value) for each in found.tried]

    alone = told(1)
    assert {names for names in alone[1] if "zero_offset" in names} == set(alone[1]) != set()
    assert alone == told(2) == told(3)


def test_a_mechanism_that_the_forward_model_cannot_follow_is_listed_with_its_reason():
    task = problem(recordings(np.random.default_rng(5), lambda c, r: (0.25 + 0.05 * r) * c.protocol.sample_time))
    eager = SearchPolicy(negligible_if_safe=1e-30)
    search = Failing(STUDY, task, RECORD_ONLY, np.random.default_rng(0), TRUTH, policy=eager)
    found = diagnose(search, lambda said: None)
    assert found.failed["zero_offset"] == "lost contact"
    assert (found.verdict, named(found.accepted)) == ("identified", ["thermal_drift"])


def test_the_base_models_fit_begins_where_the_model_of_record_does_not_fail():
    """At the end of the search with few samples it does; the last place before serves."""

    @dataclass(frozen=True, eq=False)
    class FailingRecord(ClosedForms):
        fails: bool = False

        def reanchored(self, u):
            asked.append(u)
            return replace(self, fails=len(asked) == 1)

        def tangents(self, points):
            return ["no equilibrium"] * len(points) if self.fails else super().tangents(points)

    asked, task = [], problem(recordings(np.random.default_rng(11)))
    start = {"modulus": 0.8, "fluidity": 0.02}
    failing = replace(task, forward=FailingRecord(CONDITIONS))
    found = Search(STUDY, failing, RECORD_ONLY, np.random.default_rng(0), start).base
    whole = Search(STUDY, task, RECORD_ONLY, np.random.default_rng(0), start).base
    assert found.fit.log_evidence == pytest.approx(whole.fit.log_evidence, abs=0.1)


class Frictionless(ClosedForms):
    """Whose simulations with friction fail."""

    def curves(self, points):
        acts = any(mechanism.key == "friction" for mechanism in self.mechanisms)
        return ["no equilibrium"] * len(points) if acts else super().curves(points)


def test_a_mechanism_whose_simulations_all_fail_is_left_out_and_said():
    """The others are looked at all the same."""
    observed = recordings(np.random.default_rng(3), effect=lambda c, r: 0.3 * c.protocol.sample_time)
    task = replace(problem(observed), forward=Frictionless(CONDITIONS, bodily={"friction": None}))
    found = diagnose(search_of(task, [*RECORD_ONLY, "friction"]))
    assert found.failed == {"friction": "no equilibrium"}
    assert [each.fit.explanation for each in found.accepted] == [("thermal_drift",)]
