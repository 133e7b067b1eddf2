"""The search among explanations, with fits that are given."""

from dataclasses import replace
from threading import Event
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from closed_forms import MATERIAL
from test_diagnosis import problem, recordings, search_of

from palpate.diagnosis import diagnose
from palpate.diagnosis.accepted import accepted_of, likeliest_of_each, verdict_of, without_redundant
from palpate.diagnosis.diagnose import _compared, _fitted, _prospects, _special_cases
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.search import Candidate
from palpate.diagnosis.side_by_side import Prospect, SideBySide
from palpate.errors import PalpateError
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.mechanisms import MECHANISMS

LEVEL = 0.01
POLICY = SearchPolicy()
LAW = AmplitudeConstraint("thermal_drift", "rate", 1.0, 0.9, 1.1, "a test")


def candidate(keys, evidence, p_value=0.5, occam=0.0, contradicts=()):
    fit = SimpleNamespace(
        explanation=tuple(filter(None, keys.split("+"))),
        log_evidence=evidence,
        converged=True,
        misfit_ratio=10.0,
        log_likelihood=evidence + occam,
        laws=(),
        z=None,
    )
    fit.law_misfits = np.empty(0)
    return Candidate(fit, p_value, contradicts)


def named(candidates):
    return ["+".join(each.fit.explanation) for each in candidates]


def stand(found, tried=()):
    return named(accepted_of(found, [*found, *tried], LEVEL))


def test_what_stands_is_listed_best_first():
    """Answer and curves rest on the first of the list."""
    found = [candidate("friction", 8.0), candidate("tip_angle", 9.0), candidate("adhesion", 4.0)]
    assert stand(found) == ["tip_angle", "friction"]


def test_one_that_leaves_more_than_noise_does_not_stand():
    assert stand([candidate("friction", 6.0, p_value=0.001), candidate("tip_angle", 4.0)]) == ["tip_angle"]


def test_nothing_stands_where_something_far_likelier_leaves_more_than_noise():
    """Then the truth is not among those that pass; nor would it be if that had been tried before."""
    better = candidate("friction", 9.0, p_value=0.001)
    assert stand([better, candidate("tip_angle", 4.0)]) == []
    assert stand([candidate("tip_angle", 4.0)], [better]) == []


def test_evidence_counts_from_the_best_tried_whether_that_passes_or_not():
    best = candidate("friction", 9.0, p_value=0.001)
    assert stand([best, candidate("tip_angle", 6.0, occam=3.0), candidate("adhesion", 2.0)]) == ["tip_angle"]


def test_one_that_contradicts_a_law_neither_stands_nor_keeps_others_from_it():
    against = candidate("thermal_drift", 90.0, contradicts=(LAW,))
    assert stand([against, candidate("tip_angle", 4.0)]) == ["tip_angle"]
    assert stand([against]) == []


def test_what_fits_as_well_stands_though_it_could_have_explained_much_else():
    """A thick film on a soft body gives way in proportion to the load, as a frame does."""
    frame = candidate("frame_compliance", 80.0, occam=4.0)
    assert stand([frame, candidate("film_on_substrate", 72.0, occam=11.0)]) == ["frame_compliance", "film_on_substrate"]
    assert stand([frame, candidate("film_on_substrate", 72.0, occam=6.0)]) == ["frame_compliance"]
    assert stand([frame, candidate("film_on_substrate", 72.0, p_value=0.002, occam=11.0)]) == ["frame_compliance"]


def test_the_verdict_follows_from_how_many_stand():
    assert verdict_of([]) == ("unexplained", [])
    assert verdict_of([candidate("friction", 5.0)]) == ("identified", [1.0])
    verdict, probabilities = verdict_of([candidate("friction", -4000.0), candidate("adhesion", -4000.0 - np.log(3.0))])
    assert verdict == "ambiguous"
    assert probabilities == pytest.approx([0.75, 0.25])


def test_a_set_around_a_smaller_one_that_stands_holds_what_does_nothing():
    wide, other = candidate("friction+adhesion", 9.0), candidate("adhesion+tip_angle", 8.0)
    narrow, apart = candidate("friction", 7.0), candidate("tip_rounding", 6.0)
    assert without_redundant([wide, other, narrow, apart]) == [other, narrow, apart]
    assert without_redundant([wide, other]) == [wide, other]


def test_what_may_be_accepted_on_finer_meshes_is_compared_there():
    """The mesh of a search leaves errors that the base model has no more; its evidence is rough."""
    best, behind = candidate("zero_offset", 80.0), candidate("tip_rounding", 74.0, p_value=0.005)
    likely, far = candidate("film_on_substrate", 60.0, occam=13.0), candidate("friction", 60.0)
    search = SimpleNamespace(policy=replace(POLICY, behind_adequate=10.0), explains=lambda fit: True)
    assert named(_compared(search, [best], [best, behind, likely, far])) == [
        "zero_offset",
        "tip_rounding",
        "film_on_substrate",
    ]


@pytest.fixture
def wide(monkeypatch):
    """A mechanism that includes the thermal drift."""
    declared = replace(MECHANISMS["thermal_drift"], key="wide", includes=("thermal_drift",))
    monkeypatch.setitem(MECHANISMS, "wide", declared)


@pytest.mark.usefixtures("wide")
def test_a_mechanism_is_not_needed_where_one_that_it_includes_explains_as_much():
    steady = candidate("thermal_drift", 7.0)
    assert named(without_redundant([candidate("wide", 8.5), steady])) == ["thermal_drift"]
    assert named(without_redundant([candidate("wide", 9.5), steady])) == ["wide", "thermal_drift"]
    assert named(without_redundant([candidate("wide+friction", 11.5), steady])) == ["thermal_drift"]
    pair = candidate("thermal_drift+friction", 7.0)
    assert named(without_redundant([candidate("wide+friction", 8.5), pair])) == ["thermal_drift+friction"]
    assert named(without_redundant([candidate("wide+adhesion", 8.5), pair])) == [
        "wide+adhesion",
        "thermal_drift+friction",
    ]


@pytest.mark.usefixtures("wide")
def test_a_mechanism_and_one_that_it_includes_do_not_act_together():
    found = [candidate("wide", 9.0), candidate("thermal_drift", 7.0)]
    ways = prospects(found, {}, ["thermal_drift", "wide", "friction"])
    assert [way.members for way in ways] == [{"wide", "friction"}, {"thermal_drift", "friction"}]


@pytest.mark.usefixtures("wide")
def test_what_a_law_asks_of_a_mechanism_is_promised_of_one_that_includes_it():
    base = candidate("friction", 10.0)
    base.fit.laws, base.fit.law_misfits = (LAW,), np.array([36.0])
    assert [(way.key, way.optimistic) for way in prospects([base], {}, ["wide"])] == [("wide", 28.0)]


@pytest.mark.usefixtures("wide")
def test_what_a_mechanism_includes_is_fitted_where_it_ended_itself():
    """Whatever was tried before: the special case begins at its rate, and reaches what it reached."""
    observed = recordings(np.random.default_rng(5), lambda c, r: (0.25 + 0.05 * r) * c.protocol.sample_time)
    search = search_of(problem(observed), ["thermal_drift", "wide"])
    ended = search.examined(search.joined(search.base.fit, "wide"))
    (special,) = _special_cases(search, ended, [search.base], lambda said: None)
    assert special.fit.explanation == ("thermal_drift",)
    assert special.fit.z == pytest.approx(ended.fit.z, abs=0.01)
    assert special.fit.log_evidence == pytest.approx(ended.fit.log_evidence, abs=0.1)


def test_a_set_that_was_tried_again_is_listed_once():
    stopped, found = candidate("friction+adhesion", 5.0), candidate("adhesion+friction", 9.0)
    other = candidate("adhesion", 7.0)
    assert likeliest_of_each([stopped, other, found]) == [found, other]


def tried(promises, proves=None, most=8, policy=POLICY, neighbours=lambda fit: [], ruled_out=()):
    """Return which mechanisms were fitted, in order, what came back, and what failed.

    Parameters
    ----------
    promises
        Of each mechanism, the greatest first.
    proves
        Evidence and p-value of what turns out otherwise, or the words in which its fit fails.
    neighbours
        Returns smaller fits where a fit lies.
    ruled_out
        Mechanisms with which replicates differ as they did before.
    """
    asked, failed, proves = [], {}, proves or {}

    def joined(fit, key, stop):
        asked.append(key)
        if isinstance(proves.get(key), str):
            raise PalpateError(proves[key])
        return key

    def examined(key):
        return candidate(key, *proves.get(key, (promises[key], 0.0)))

    methods = {"joined": joined, "examined": examined, "neighbours": neighbours, "explains": lambda fit: False}
    methods["cannot_leave_noise"] = lambda fit, key: key in ruled_out
    search = searching(promises, policy=policy, **methods)
    found = _fitted(SideBySide(search), [candidate("", 0.0)], most, failed, lambda said: None)
    return asked, named(found), failed


def searching(promises, **methods):
    """Return a search that sees what is promised beside the base model, and nothing more beside other fits."""

    def gain(fit, key):
        return 2.0 * promises[key] if not fit.log_evidence else 0.0

    screen = SimpleNamespace(keys=list(promises), gain=gain)
    return SimpleNamespace(screen=screen, study=SimpleNamespace(diagnosis={"significance": LEVEL}), **methods)


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

    asked, ahead = (Prospect(candidate("", 0.0).fit, key, 0.0) for key in ("friction", "adhesion"))
    with SideBySide(SimpleNamespace(policy=SearchPolicy(threads=2), joined=joined)) as fits:
        assert fits.fitted(asked, [ahead]) is asked.fit
        assert not ended.is_set()
    assert ended.is_set()


@pytest.mark.parametrize(
    ("begun", "ended", "evidences", "best"),
    [(0.5, 0.5, [1.0], 0), (0.5, -3.0, [1.0, 5.0], 1), (-3.0, 0.5, [1.0], 0), (-3.0, -3.0, [5.0, 1.0], 0)],
)
def test_a_fit_that_begins_or_ends_far_outside_the_ranges_is_tried_from_within(begun, ended, evidences, best):
    search = search_of(problem(recordings(np.random.default_rng(1))))
    smaller = replace(search.base.fit, z=np.array([begun, 0.3]))
    key, asked, end = "frame_compliance", [], np.array([ended, 0.3])
    ends = [SimpleNamespace(coordinates=MATERIAL, z=end, log_evidence=e, misfit_ratio=1.0) for e in evidences]
    search._fitter.policy = replace(search._fitter.policy, finer_meshes=0.0)  # the smaller one leaves more than noise

    def fitted(explanation, starts, *others):
        asked.append(starts)
        return ends[len(asked) - 1]

    with patch.object(search._fitter, "fitted", fitted):
        assert search.joined(smaller, key) is ends[best]
    assert len(asked) == len(evidences)
    within = 0 if begun == -3.0 else 1
    assert len(asked) <= within or asked[within][0][:2] == pytest.approx([0.5, 0.3])


def test_larger_sets_follow_where_what_explained_does_not_in_the_end(monkeypatch):
    """The drift leaves more than noise after its last steps, so friction beside it is tried; the drift is its base."""
    drift, ended = candidate("thermal_drift", 10.0), candidate("thermal_drift", 11.0, 0.001)
    both = candidate("thermal_drift+friction", 20.0)
    rounds, asked = iter([[drift], [both]]), []

    def fitted(side_by_side, smaller, *others):
        asked.append(named(smaller))
        return next(rounds)

    replaced = {"_fitted": fitted, "_larger": lambda *given: [], "_special_cases": lambda *given: []}
    replaced["_finished"] = lambda search, chosen, report: [ended if each is drift else each for each in chosen]
    for name, function in replaced.items():
        monkeypatch.setattr(diagnose, name, function)
    study = SimpleNamespace(diagnosis={"significance": LEVEL, "largest_set": 2})
    search = SimpleNamespace(study=study, policy=POLICY, base=candidate("", 0.0, 0.0), explains=lambda fit: False)
    accepted, _ = diagnose._accepted(SimpleNamespace(search=search), {}, print)
    assert named(accepted) == ["thermal_drift+friction"]
    assert asked == [[""], ["thermal_drift"]]


FAR = {"tip_angle": 100.0, "tip_rounding": 90.0, "friction": 80.0, "adhesion": 70.0, "thermal_drift": 50.0}


def test_what_promises_most_is_fitted_first_and_comes_back_best_first():
    asked, found, failed = tried({"tip_angle": 100.0, "friction": 99.0}, {"tip_angle": (20.0, 0.0)})
    assert asked == ["tip_angle", "friction"]
    assert found == ["friction", "tip_angle"]
    assert failed == {}


def test_a_rival_is_not_left_out_because_another_promised_too_much():
    """A frame beside a film that is hard to foresee: it promised far less than the film, yet more than that proved."""
    promises = {"film_on_substrate": 300.0, "frame_compliance": 105.0, "friction": 80.0}
    proves = {"film_on_substrate": (100.0, 0.5), "frame_compliance": (104.0, 0.4)}
    asked, found, _ = tried(promises, proves)
    assert asked == ["film_on_substrate", "frame_compliance"]
    assert found == ["frame_compliance", "film_on_substrate"]


def test_what_falls_far_behind_is_left_out_once_some_are_fitted():
    assert tried(FAR, policy=replace(POLICY, least=4))[0] == ["tip_angle", "tip_rounding", "friction", "adhesion"]
    assert tried(FAR, policy=replace(POLICY, least=2, behind_best=15.0))[0] == ["tip_angle", "tip_rounding"]
    assert tried(FAR, policy=replace(POLICY, least=5))[0] == list(FAR)


def test_a_rival_is_looked_at_again_from_where_one_that_explains_lies():
    """Beside the base model's optimum a film promised little; beside the frame's material it promises as much."""
    promises = {"frame_compliance": 100.0, "film_on_substrate": 30.0, "friction": 20.0}
    proves = {"frame_compliance": (100.0, 0.5), "film_on_substrate": (99.0, 0.5)}
    assert tried(promises, proves)[0] == ["frame_compliance"]
    there = candidate("", 97.0).fit
    asked, found, _ = tried(promises, proves, neighbours=lambda fit: [there])
    assert asked == ["frame_compliance", "film_on_substrate", "friction"]
    assert found[:2] == ["frame_compliance", "film_on_substrate"]


def test_what_joins_a_fit_near_the_recordings_is_left_out_at_once_where_it_falls_far_behind():
    policy = replace(POLICY, least=4, trusted=10.0)
    assert tried(FAR, policy=policy)[0] == [key for key in FAR if FAR[key] >= 100.0 - policy.behind_best]


def test_what_would_not_stand_beside_one_that_leaves_only_noise_is_left_out():
    assert tried(FAR, {"tip_angle": (100.0, 0.5)})[0] == ["tip_angle", "tip_rounding"]
    assert tried(FAR, {"tip_angle": (101.0, 0.5)})[0] == ["tip_angle"]
    assert tried(FAR, {"tip_rounding": (95.0, 0.5)})[0] == ["tip_angle", "tip_rounding"]


def test_what_cannot_explain_replicates_is_left_out_beside_what_does_unless_it_is_far_likelier():
    promises = {"friction": 110.0, "thermal_drift": 105.0, "tip_angle": 104.0, "zero_offset": 101.0}
    proves = {"thermal_drift": (100.0, 0.5)}
    asked, _, _ = tried(promises, proves, ruled_out=("friction", "tip_angle"))
    assert asked == ["friction", "thermal_drift", "zero_offset"]
    asked, _, _ = tried(promises | {"tip_angle": 104.9}, proves, ruled_out=("friction", "tip_angle"))
    assert asked == ["friction", "thermal_drift", "tip_angle", "zero_offset"]


def test_no_more_are_fitted_than_the_policy_allows():
    assert tried(FAR, most=3)[0] == ["tip_angle", "tip_rounding", "friction"]


def test_an_explanation_that_cannot_be_fitted_is_recorded_and_others_go_on():
    asked, found, failed = tried(FAR, {"tip_angle": "the mesh folds", "tip_rounding": (90.0, 0.5)})
    assert asked == ["tip_angle", "tip_rounding", "friction"]
    assert found == ["tip_rounding", "friction"]
    assert failed == {"tip_angle": "the mesh folds"}


def test_what_failed_among_sets_is_recorded_by_all_its_mechanisms():
    def joined(fit, key, stop):
        raise PalpateError("no convergence")

    search, failed = searching({"adhesion": 5.0}, policy=POLICY, joined=joined, examined=None), {}
    assert _fitted(SideBySide(search), [candidate("friction", 3.0)], 5, failed, lambda said: None) == []
    assert failed == {"adhesion+friction": "no convergence"}


def prospects(found, gains, keys):
    screen = SimpleNamespace(keys=keys, gain=lambda fit, key: gains.get((*fit.explanation, key), 0.0))
    ways = _prospects(SimpleNamespace(screen=screen), [each.fit for each in found])
    assert all(members == way.members for members, way in ways.items())
    return sorted(ways.values(), key=lambda way: -way.optimistic)


def test_a_prospect_promises_half_of_what_chi_square_may_fall():
    ways = prospects([candidate("friction", 10.0)], {("friction", "tip_angle"): 8.0}, ["adhesion", "tip_angle"])
    assert [(way.key, way.optimistic) for way in ways] == [("tip_angle", 14.0), ("adhesion", 10.0)]


def test_a_set_is_a_prospect_once_by_its_likeliest_way():
    found, keys = [candidate("friction", 10.0), candidate("adhesion", 12.0)], ["friction", "adhesion", "tip_angle"]
    gains = {("friction", "adhesion"): 30.0, ("adhesion", "friction"): 10.0, ("adhesion", "tip_angle"): 40.0}
    ways = prospects(found, gains, keys)
    assert [(*way.fit.explanation, way.key) for way in ways] == [
        ("adhesion", "tip_angle"),
        ("friction", "adhesion"),
        ("friction", "tip_angle"),
    ]
    assert ways[1].members == {"adhesion", "friction"}


def test_what_a_law_asks_for_is_promised_too():
    """A fit without the drift departs from a law of the drift by six standard deviations."""
    base = candidate("friction", 10.0)
    base.fit.laws, base.fit.law_misfits = (LAW,), np.array([36.0])
    ways = prospects([base], {}, ["adhesion", "thermal_drift"])
    assert [(way.key, way.optimistic) for way in ways] == [("thermal_drift", 28.0), ("adhesion", 10.0)]
