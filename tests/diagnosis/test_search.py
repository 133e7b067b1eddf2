"""The search among explanations and what follows from their probabilities, with fits that are given."""

from dataclasses import replace
from math import comb
from threading import Event
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from closed_forms import MATERIAL
from diagnosis_problem import problem, recordings, search_of

from palpate.configuration.settings import DiagnosisSettings
from palpate.diagnosis.diagnose import _explore
from palpate.diagnosis.explanations import (
    Explanations,
    acting,
    inclusion,
    log_prior,
    may_act_together,
    simplest,
    smallest_group,
)
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.search import Candidate
from palpate.diagnosis.side_by_side import ExplanationToTry, ParallelFits
from palpate.errors import PalpateError
from palpate.mechanisms import MECHANISMS

POLICY = SearchPolicy()


def candidate(keys, evidence, contradicts=()):
    fit = SimpleNamespace(explanation=tuple(filter(None, keys.split("+"))), log_evidence=evidence, converged=True)
    return Candidate(fit, lambda fit: 0.5, contradicts)


def named(candidates):
    return ["+".join(each.fit.explanation) for each in candidates]


def explanations(considered=10, estimated=None, **evidences):
    found = Explanations(considered)
    found.add(candidate("", 0.0))
    for keys, evidence in evidences.items():
        found.add(candidate(keys.replace("__", "+"), evidence))
    for keys, evidence in (estimated or {}).items():
        found.estimate(frozenset(keys.split("+")), frozenset(), evidence)
    return found


def test_the_prior_of_all_sets_is_one_and_half_of_it_is_for_none():
    assert sum(comb(12, k) * np.exp(log_prior(k, 12)) for k in range(13)) == pytest.approx(1.0)
    assert np.exp(log_prior(0, 12)) == pytest.approx(0.5)


def test_probabilities_are_those_of_evidence_times_prior_over_all_sets():
    found = explanations(friction=3.0, estimated={"adhesion": 2.0}).probabilities()
    weights = [
        1.0,
        np.exp(3.0 + log_prior(1, 10) - log_prior(0, 10)),
        np.exp(2.0 + log_prior(1, 10) - log_prior(0, 10)),
    ]
    expected = np.array(weights) / sum(weights)
    assert found[frozenset()] == pytest.approx(expected[0])
    assert found[frozenset({"friction"})] == pytest.approx(expected[1])
    assert found[frozenset({"adhesion"})] == pytest.approx(expected[2])


def test_evidence_counts_to_its_power_and_the_prior_in_full():
    found = Explanations(10, power=0.5)
    for keys, evidence in {"": 0.0, "friction": 12.0}.items():
        found.add(candidate(keys, evidence))
    chances = found.probabilities()
    odds = chances[frozenset({"friction"})] / chances[frozenset()]
    assert odds == pytest.approx(np.exp(6.0 + log_prior(1, 10) - log_prior(0, 10)))


def test_a_set_that_an_exact_law_contradicts_has_no_probability():
    found = Explanations(10)
    found.add(candidate("", 0.0))
    found.add(candidate("friction", 50.0, contradicts=("a law",)))
    assert found.probabilities()[frozenset({"friction"})] == 0.0


def test_of_one_set_the_likeliest_fit_counts():
    found = explanations(friction=3.0)
    found.add(candidate("friction", 1.0))
    assert found.fitted[frozenset({"friction"})].fit.log_evidence == 3.0
    found.add(candidate("friction", 7.0))
    assert found.fitted[frozenset({"friction"})].fit.log_evidence == 7.0


@pytest.mark.parametrize(("special", "rivals"), [(29.0, 1), (20.0, 1)])
def test_a_special_case_is_no_rival_to_its_general_form(special, rivals):
    """The simpler one is named where it is not excluded; else the general one is."""
    found = explanations(thermal_drift=special, nonsteady_drift=30.0).probabilities()
    drifts = [members for members in found if members & {"thermal_drift", "nonsteady_drift"} and found[members] > 0.01]
    assert len(drifts) == rivals
    assert drifts[0] == ({"thermal_drift"} if special == 29.0 else {"nonsteady_drift"})


def test_a_mechanism_and_one_that_it_includes_do_not_act_together():
    assert not may_act_together(("thermal_drift", "nonsteady_drift"))
    assert not may_act_together(("mount_compliance", "frame_compliance"))
    assert may_act_together(("thermal_drift", "frame_compliance"))


def test_the_group_is_the_smallest_that_holds_the_probability():
    sets = {frozenset("a"): 0.6, frozenset("b"): 0.3, frozenset("c"): 0.08, frozenset("d"): 0.02}
    assert smallest_group(sets, 0.95) == [frozenset("a"), frozenset("b"), frozenset("c")]
    assert smallest_group(sets, 0.5) == [frozenset("a")]


def test_a_set_is_no_rival_to_a_smaller_one_that_it_contains():
    one, both, other = frozenset({"friction"}), frozenset({"friction", "adhesion"}), frozenset({"tip_angle"})
    assert simplest([one, both, other]) == [one, other]
    assert simplest([both, frozenset(), other]) == [frozenset()]
    assert simplest([both, other]) == [both, other]


def test_an_effect_below_the_smallest_counts_as_none():
    both, one = frozenset({"friction", "adhesion"}), frozenset({"friction"})
    found = acting({both: 0.8, frozenset(): 0.2}, {both: {"friction": 1.0, "adhesion": 0.25}})
    assert found == pytest.approx({one: 0.6, both: 0.2, frozenset(): 0.2, frozenset({"adhesion"}): 0.0})


def test_inclusion_sums_over_all_sets_and_families_count_once():
    sets = {
        frozenset({"thermal_drift", "friction"}): 0.5,
        frozenset({"nonsteady_drift"}): 0.3,
        frozenset({"tip_angle", "tip_rounding"}): 0.2,
    }
    assert inclusion(sets) == pytest.approx(
        {"thermal_drift": 0.5, "friction": 0.5, "nonsteady_drift": 0.3, "tip_angle": 0.2, "tip_rounding": 0.2}
    )
    assert inclusion(sets, families=True) == pytest.approx({"drift": 0.8, "friction": 0.5, "tip": 0.2})


def test_every_mechanism_belongs_to_a_family():
    assert all(mechanism.family for mechanism in MECHANISMS.values())


def explored(expected, proves=None, policy=POLICY, largest=2, replicated=True):
    """Return which sets were fitted, in order, all explanations, and what failed.

    Parameters
    ----------
    expected
        Log evidence to first order of each set that joins another one, by its mechanisms.
    proves
        Log evidence of what turns out otherwise, or the words in which its fit fails.
    """
    asked, failed, proves = [], {}, proves or {}

    def name(fit, key):
        return "+".join(sorted((*fit.explanation, key)))

    def joined(fit, key, stop):
        asked.append(name(fit, key))
        found = proves.get(asked[-1], expected[asked[-1]])
        if isinstance(found, str):
            raise PalpateError(found)
        return candidate(asked[-1], found).fit

    keys = sorted({key for names in expected for key in names.split("+")})
    search = SimpleNamespace(
        screen=SimpleNamespace(keys=keys),
        study=SimpleNamespace(diagnosis=DiagnosisSettings(largest_set=largest)),
        policy=policy,
        base=candidate("", 0.0),
        joined=joined,
        log_evidence=lambda fit, key: expected.get(name(fit, key), -1e3),
        candidate=lambda fit: Candidate(fit, lambda fit: 0.5),
        problem=SimpleNamespace(is_simulated=lambda key: key != "thermal_drift", replicated=replicated),
    )
    found = Explanations(len(keys))
    found.add(search.base)
    with ParallelFits(search) as fits:
        _explore(fits, found, failed, lambda said: None)
    return asked, found, failed


def test_the_likeliest_is_fitted_first_and_what_is_negligible_is_not_fitted():
    asked, found, _ = explored({"friction": 30.0, "adhesion": 27.0, "tip_angle": 29.0, "thermal_drift": -5.0})
    assert asked == ["friction", "tip_angle", "adhesion"]
    assert frozenset({"thermal_drift"}) in found.estimated


def test_what_only_adds_to_the_depth_is_fitted_where_it_may_change_what_is_said():
    """Its evidence to first order is that of a refit, for all that matters."""
    asked, _, _ = explored({"friction": 30.0, "thermal_drift": 26.5, "adhesion": 26.5})
    assert asked == ["friction", "adhesion"]
    assert explored({"friction": 30.0, "thermal_drift": 28.5})[0] == ["friction", "thermal_drift"]


def test_nothing_is_fitted_where_no_set_may_matter_beside_none():
    asked, found, _ = explored({"friction": -6.0, "adhesion": -7.0})
    assert asked == []
    assert found.probabilities()[frozenset()] > 0.99


def test_without_replicates_a_set_is_fitted_only_where_it_may_be_about_as_likely_as_a_part_of_it():
    assert explored({"friction": -5.0})[0] == ["friction"]
    assert explored({"friction": -5.0}, replicated=False)[0] == []


def test_larger_sets_are_estimated_from_each_fit():
    asked, _, _ = explored({"friction": 20.0, "adhesion": 12.0, "adhesion+friction": 40.0})
    assert asked == ["friction", "adhesion+friction"]


def test_twins_of_a_pair_are_fitted_whichever_of_them_came_first():
    """Friction and adhesion look alike alone; beside a tip angle the one that was fitted second must not be lost."""
    alike = {"friction": 30.0, "adhesion": 27.0, "friction+tip_angle": 60.0, "adhesion+tip_angle": 57.5}
    asked, found, _ = explored(alike | {"tip_angle": -20.0})
    assert asked == ["friction", "friction+tip_angle", "adhesion", "adhesion+tip_angle"]
    first, second = (found.probabilities()[frozenset({key, "tip_angle"})] for key in ("friction", "adhesion"))
    assert second / first == pytest.approx(np.exp(-2.5), rel=1e-6)


def test_no_more_are_fitted_than_the_policy_allows_and_no_larger_sets_than_the_study():
    every = {"friction": 30.0, "adhesion": 29.0, "tip_angle": 28.0, "adhesion+friction": 60.0}
    assert len(explored(every, policy=replace(POLICY, most=2))[0]) == 2
    assert all("+" not in name for name in explored(every, largest=1)[0])


def test_an_explanation_that_cannot_be_fitted_is_recorded_and_others_go_on():
    asked, found, failed = explored({"friction": 30.0, "adhesion": 29.0}, {"friction": "no contact"})
    assert asked[:2] == ["friction", "adhesion"]
    assert failed["friction"] == "no contact"
    assert frozenset({"friction"}) not in found.probabilities()


def test_a_fit_begun_ahead_ends_with_the_search():
    """Nothing runs on that nobody will ask for."""
    begun, ended = Event(), Event()

    def joined(fit, key, stop):
        if key == "friction":
            assert begun.wait(60.0)
            return fit
        begun.set()
        assert stop.wait(60.0)
        ended.set()

    asked, ahead = (ExplanationToTry(candidate("", 0.0).fit, key, 0.0) for key in ("friction", "adhesion"))
    with ParallelFits(SimpleNamespace(policy=SearchPolicy(threads=2), joined=joined)) as fits:
        assert fits.fitted(asked, [ahead]) is asked.fit
        assert not ended.is_set()
    assert ended.is_set()


EXACT = SimpleNamespace(law=None)


@pytest.mark.parametrize(
    ("begun", "ended", "evidences", "best"),
    [(0.5, 0.5, [1.0], 0), (0.5, -3.0, [1.0, 5.0], 1), (-3.0, 0.5, [1.0], 0), (-3.0, -3.0, [5.0, 1.0], 0)],
)
def test_a_fit_that_begins_or_ends_far_outside_the_ranges_is_tried_from_within(begun, ended, evidences, best):
    search = search_of(problem(recordings(np.random.default_rng(1))))
    smaller = replace(search.base.fit, z=np.array([begun, 0.3]))
    key, asked, end = "frame_compliance", [], np.array([ended, 0.3])
    ends = [
        SimpleNamespace(coordinates=MATERIAL, z=end, log_evidence=e, misfit_ratio=1.0, errors=EXACT) for e in evidences
    ]
    search._fitter.policy = replace(search._fitter.policy, finer_meshes=0.0)  # the smaller one leaves more than noise

    def fitted(explanation, starts, *others):
        asked.append(starts)
        return ends[len(asked) - 1]

    with patch.object(search._fitter, "fitted", fitted):
        assert search.joined(smaller, key) is ends[best]
    assert len(asked) == len(evidences)
    within = 0 if begun == -3.0 else 1
    assert len(asked) <= within or asked[within][0][:2] == pytest.approx([0.5, 0.3])
