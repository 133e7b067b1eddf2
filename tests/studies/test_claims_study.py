"""The study of how often claims are true: its closed forms, its departures, and its scores on known answers."""

import json
from dataclasses import asdict, replace

import numpy as np
import pandas as pd
import pytest
from scipy.special import expit

from palpate.classical.viscoelastic_depth import Compliance
from palpate.study.protocol import trapezoid
from studies.claims import SEED, score
from studies.claims.body import KEYS, BodyWithMechanisms, of_body, recorded
from studies.claims.departures import DEPARTURES
from studies.claims.diagnoses import posed
from studies.claims.sets import KINDS, Case, draw, recordings
from studies.coverage.creep import POISSON_RATIO, burgers, depth
from studies.coverage.solid import MATERIAL

SOLID = burgers(3.0, 0.001, 0.1, 20.0)
TEST = trapezoid(5.0, 20.0, 20.0, 20.0, points=60)


def test_mechanisms_that_are_neutral_change_nothing():
    neutral = {
        "film_on_substrate": {"thickness": 1e9, "substrate_modulus": 70.0},
        "size_effect": {"length": 0.0},
        "tip_rounding": {"radius": 1e-3},
        "tip_angle": {"half_angle": 70.3},
        "controller_lag": {"lag": 0.0},
        "frame_compliance": {"compliance": 0.0},
    }
    assert recorded(SOLID, TEST, neutral) == pytest.approx(depth(SOLID, TEST), rel=1e-5, abs=1e-3)


def test_effects_have_their_known_limits():
    """A thin film is as stiff as its substrate; a small depth has the resistance of Nix and Gao."""
    elastic = Compliance((1.0 - POISSON_RATIO**2) / 3.0, 0.0, ())
    film = of_body(elastic, TEST, {"film_on_substrate": {"thickness": 1.0, "substrate_modulus": 12.0}})
    assert (film / depth(elastic, TEST))[:-1] == pytest.approx(0.5, rel=0.02)
    found = of_body(elastic, TEST, {"size_effect": {"length": 300.0}})[:-1]
    assert found**2 * np.sqrt(1.0 + 300.0 / found) == pytest.approx(depth(elastic, TEST)[:-1] ** 2, rel=1e-6)


def test_what_departs_leaves_the_wanted_misfit_after_a_refit():
    case = next(each for each in draw(range(1, 60, 5), 7) if not each.mechanisms)
    exact = [depth(burgers(**case.parameters), test.protocol) for test in case.conditions]
    largest = np.concatenate([np.maximum.accumulate(curve) for curve in exact])
    ((_, slopes),) = BodyWithMechanisms(case.conditions).tangents([MATERIAL.scaled(case.parameters)])
    tangent = np.concatenate([slopes[test.name] for test in case.conditions]) / largest[:, None]
    change = np.concatenate(case.departed()) / largest
    rest = change - tangent @ np.linalg.lstsq(tangent, change, rcond=None)[0]
    assert np.sqrt(np.mean(rest**2)) == pytest.approx(case.misfit, rel=1e-6)


@pytest.mark.parametrize("kind", DEPARTURES)
def test_a_law_obeys_the_scaling_law_and_knows_only_the_past_and_what_has_a_length_does_not(kind):
    """At nine times the load a law changes three times the depth; two tests are alike until one of them turns."""
    small, large = (trapezoid(load, 20.0, 20.0, 20.0, points=60) for load in (1.0, 9.0))
    longer = trapezoid(18.0, 40.0, 20.0, 20.0, points=60)
    for change in DEPARTURES[kind].values():
        of_small, of_large, of_longer = (
            change(test, depth(SOLID, test), SOLID, np.random.default_rng(0)) for test in (small, large, longer)
        )
        scales = np.allclose(of_large, 3.0 * of_small, rtol=1e-6, atol=1e-6 * np.abs(of_large).max())
        assert scales == (kind == "scaling")
        if scales:
            until = np.linspace(1.0, 19.0, 10)
            before, after = (np.interp(until, t.sample_time, c) for t, c in ((large, of_large), (longer, of_longer)))
            assert after == pytest.approx(before, abs=0.03 * np.abs(of_large).max())


def test_sets_come_from_their_number_alone_and_every_kind_has_nulls():
    cases = draw(range(100), SEED)
    assert [each.kind for each in cases[:5]] == list(KINDS)
    assert asdict(draw([17], SEED)[0]) == asdict(cases[17])
    nulls = pd.Series([each.kind for each in cases if not each.mechanisms]).value_counts()
    assert set(nulls) == {12}
    again = Case(**json.loads(json.dumps(asdict(cases[16]))))
    name = again.conditions[0].name
    assert np.array_equal(recordings(again)[name].response, recordings(cases[16])[name].response)
    assert {each.departure for each in cases} <= {"", *(name for kind in DEPARTURES.values() for name in kind)}


def test_a_mechanism_that_joins_acts_as_in_the_laboratory():
    case = next(each for each in draw(range(0, 200, 5), 3) if len(each.mechanisms) == 1)
    ((key, values),) = case.mechanisms.items()
    problem = posed(case)
    model = problem.model((key,))
    searched = {f"{key}.{name}": value for name, value in values.items()}
    (curves,) = model.curves([model.coordinates.scaled({**case.parameters, **searched})])
    for test in case.conditions:
        assert curves[test.name] == pytest.approx(recorded(burgers(**case.parameters), test.protocol, case.mechanisms))
    assert set(KEYS) >= set(case.mechanisms)


def test_scores_find_answers_that_are_calibrated_and_those_that_are_not():
    rng = np.random.default_rng(1)
    logits = rng.normal(0.0, 1.5, 4000)
    acts = rng.random(4000) < expit(logits)
    table = pd.DataFrame({"stated": expit(logits), "acts": acts, "strong": acts})
    right = score.calibration(table)
    assert right["lower"] < 1.0 < right["upper"]
    assert right["log_score"] > right["log_score_of_rate"]
    sure = score.calibration(table.assign(stated=expit(3.0 * logits)))
    assert sure["upper"] < 0.7


def test_a_name_is_wrong_unless_it_or_its_special_or_general_case_was_planted():
    (case,) = (each for each in draw([30], SEED))
    case = replace(case, kind="none", departure="", mechanisms={"thermal_drift": {"rate": 0.5}})
    stated = {
        "verdict": "identified",
        "candidates": [["thermal_drift"]],
        "material": {},
        "over_all_sets": {},
        "amplitudes": {},
        "law": {},
        "nothing_further": 1.0,
        "seconds": 1.0,
    }
    for named, wrong in (["thermal_drift"], False), (["nonsteady_drift"], False), (["frame_compliance"], True):
        assert score.row(case, {**stated, "named": named}, 0.003)["wrong_name"] is wrong


def test_an_effect_is_strong_unless_the_parameters_or_what_departs_do_the_same():
    """The angle of the only tip is a change of the stiffness; a drift is not, until what departs is larger."""
    (case,) = (each for each in draw([30], SEED))
    case = replace(
        case,
        kind="none",
        departure="",
        misfit=0.0,
        mechanisms={"thermal_drift": {"rate": 2.0}, "tip_angle": {"half_angle": 71.3}},
    )
    assert score.planted(case, 0.003)[1] == {"thermal_drift": True, "tip_angle": False}
    assert not any(score.planted(replace(case, misfit=1.0), 0.003)[1].values())
