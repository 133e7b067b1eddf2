"""Diagnosis on recordings whose noise and effects are known exactly; base model and effects are closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from closed_forms import MATERIAL, TRUTH, cone, rounded
from diagnosis_problem import CONDITIONS, RECORD_ONLY, SCALE, fitted, problem, recordings, search_of
from scipy.linalg import toeplitz

from palpate.data.contrasts import Replicates, contrasts
from palpate.data.measures import root_mean_square
from palpate.data.noise_fit import fit_noise
from palpate.diagnosis.detect import examine
from palpate.diagnosis.diagnose import _complete, sufficient_to_identify
from palpate.diagnosis.explanations import Explanations
from palpate.diagnosis.limits import outside
from palpate.diagnosis.locate import Residuals, missing_physics
from palpate.inference.covariance import errors, model_covariance, noise_of
from palpate.mechanisms import MECHANISMS
from palpate.observables import OBSERVABLES, Quantity
from palpate.study.prescribed_segments import segments
from palpate.study.protocol import trapezoid


def test_evidence_is_the_likelihood_averaged_over_the_ranges():
    """The even prior has density one: summed up on a grid over five standard deviations about the best fit."""
    fit = fitted(problem(recordings(np.random.default_rng(2))))
    spread = 5.0 * np.sqrt(np.diag(fit.posterior))
    axes = [np.linspace(z - s, z + s, 61) for z, s in zip(fit.z, spread, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    assert points.min() > 0.0 and points.max() < 1.0
    curves = np.array([fit.problem.stacked(curve) for curve in fit.model.curves(points)])
    white = fit.whiten((fit.problem.mean - curves).T)
    likelihood = fit.errors.noise.log_likelihood - 0.5 * np.sum(white**2, axis=0) - fit.log_volume
    cell = np.prod([axis[1] - axis[0] for axis in axes])
    assert fit.log_evidence == pytest.approx(
        np.log(cell * np.exp(likelihood - likelihood.max()).sum()) + likelihood.max(), abs=0.05
    )


def p_value(task, rng):
    search = search_of(task)
    return examine(search.base.fit, search.screen, rng, 400, 0.01)


@pytest.mark.parametrize("replicates", [1, 3])
def test_a_factor_of_the_site_is_left_out_where_no_replicates_give_its_scatter(replicates):
    fit = fitted(problem(recordings(np.random.default_rng(1), replicates=replicates)), ())
    off = 0.01 * np.concatenate([fit.curve[: len(fit.problem.observed["a"].time)], np.zeros(len(fit.curve))])
    shallower = replace(fit, curve=fit.curve - off[: len(fit.curve)])
    left = np.linalg.norm(shallower.left - fit.left) / np.linalg.norm(off)
    assert left < 0.3 if replicates == 1 else left == pytest.approx(1.0), "slow drift takes the rest"


def test_an_effect_errs_by_the_same_part_everywhere():
    task = problem(recordings(np.random.default_rng(1)))
    noise, film = noise_of(task, (), task.mean, 0.01), {"film_on_substrate": np.full(len(task.mean), 40.0)}
    plain, wider = (errors(task, task.forward, (), task.mean, noise, 0.003, effects) for effects in ({}, film))
    off = 40.0 * MECHANISMS["film_on_substrate"].solver_scatter
    assert wider.model - plain.model == pytest.approx(np.full(plain.model.shape, off**2))


def test_the_error_of_grid_convergence_is_one_factor_on_all_curves():
    """A depth that is off by a common factor costs what that factor costs, however long the curves are."""
    task = problem(recordings(np.random.default_rng(1)))
    covariance = model_covariance(task.split(task.mean), 0.003, {})
    assert covariance == pytest.approx(np.outer(0.003 * task.mean, 0.003 * task.mean))
    off = 0.006 * task.mean
    assert off @ np.linalg.solve(covariance + 1e-6 * np.eye(len(off)), off) == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize("effect", [lambda c, r: 0.0, lambda c, r: 0.25 * c.protocol.sample_time])
def test_the_evidence_to_first_order_orders_the_effects_as_their_fits_do(effect):
    """A drift, a frame and an offset add to the depth in proportion to their amplitudes."""
    search = search_of(problem(recordings(np.random.default_rng(2), effect)))
    base = search.base.fit
    first = {key: search.log_evidence(base, key) - base.log_evidence for key in RECORD_ONLY}
    fitted_ = {key: search.joined(base, key).log_evidence - base.log_evidence for key in RECORD_ONLY}
    assert max(first, key=first.get) == max(fitted_, key=fitted_.get) or max(fitted_.values()) < 0.0
    for key in RECORD_ONLY:
        assert first[key] == pytest.approx(fitted_[key], abs=4.0 + 0.5 * abs(fitted_[key]))


def test_noise_is_recovered_from_replicates():
    rng = np.random.default_rng(3)
    time = np.linspace(1, 100, 80)
    sets = []
    for height in (300.0, 500.0, 800.0, 1200.0):
        depth = height * np.sqrt(time / 100)
        covariance = 1.5**2 * toeplitz(0.7 ** np.arange(80)) + 0.02**2 * np.outer(depth, depth)
        rows = rng.multivariate_normal(depth, covariance, size=6, method="cholesky")
        parts = {"site": np.outer(depth, depth), "random_walk": np.minimum.outer(time, time)}
        sets.append(Replicates(contrasts(rows), np.eye(80), parts, height))
    found = fit_noise(sets, {"site": 1e-4, "random_walk": 1e-4}, True, {})
    assert found.sigma == pytest.approx(1.5, rel=0.15)
    assert found.autocorrelation == pytest.approx(0.7, abs=0.1)
    assert np.sqrt(found.variances["site"]) == pytest.approx(0.02, rel=0.4)
    assert np.sqrt(found.variances["random_walk"]) < 0.1


def test_null_recordings_with_correlated_noise_are_left_alone():
    rng = np.random.default_rng(11)
    p = [p_value(problem(recordings(rng)), rng) for _ in range(12)]
    assert np.mean(np.array(p) < 0.05) <= 0.2
    assert min(p) >= 0.002


@pytest.mark.parametrize(
    ("key", "effect", "truth"),
    [
        ("frame_compliance", lambda c, r: 8.0 * c.protocol.sample_load, 8.0),
        ("thermal_drift", lambda c, r: (0.25 + 0.05 * r) * c.protocol.sample_time, 0.30),
        ("zero_offset", lambda c, r: 9.0 + r, 10.0),
    ],
)
def test_a_planted_effect_is_noticed_and_measured(key, effect, truth):
    task = problem(recordings(np.random.default_rng(5), effect))
    search = search_of(task)
    assert search.base.p_value < 0.01
    found = {other: search.candidate(search.joined(search.base.fit, other)) for other in RECORD_ONLY}
    assert max(found, key=lambda name: found[name].fit.log_evidence) == key
    best = found[key]
    (estimate,) = task.amplitudes((key,), best.fit.z)[key].values()
    assert estimate == pytest.approx(truth, rel=0.15)
    assert best.p_value > 0.01


def test_what_acts_on_the_body_is_screened_and_fitted_on_the_forward_model():
    planted = recordings(np.random.default_rng(4), lambda c, r: rounded(c.protocol, {"radius": 60.0}))
    search = search_of(problem(planted, tip_rounding=rounded), [*RECORD_ONLY, "tip_rounding"])
    assert np.allclose(search.screen.trials["tip_rounding"][:, 0], [0.05, 0.25, 0.75, 1.0])
    found = search.candidate(search.joined(search.base.fit, "tip_rounding"))
    assert search.base.p_value < 0.01 < found.p_value
    radius, slope = found.fit.problem.quantity(("tip_rounding",), found.fit.z, "tip_rounding.radius")
    assert abs(radius - 60.0) < 3.0 * slope * np.sqrt(found.fit.posterior[-1, -1])


def test_location_points_at_the_part_that_differs():
    def late_hold(condition, replicate):
        where = segments(condition.protocol).get("hold", np.zeros(60, dtype=bool))
        return 10.0 * where * (condition.name == "b")

    first = Residuals.of(fitted(problem(recordings(np.random.default_rng(2), late_hold)))).located()[0]
    assert (first["condition"], first["segment"]) == ("b", "hold")
    assert first["q_value"] < 0.05
    assert first["residual_nm"] > 0


def test_a_recorded_load_that_is_too_large_lies_where_the_depth_is_too_small():
    fit = fitted(problem(recordings(np.random.default_rng(2))))
    load = Quantity(OBSERVABLES["load"], 1.0, -1.0)
    loads = {name: replace(item, quantity=load) for name, item in fit.problem.recorded.items()}
    under_displacement = replace(fit, problem=replace(fit.problem, recorded=loads))
    for deeper, larger in zip(Residuals.of(fit).located(), Residuals.of(under_displacement).located(), strict=True):
        assert larger["residual_nm"] == pytest.approx(-deeper["residual_nm"])


def test_what_is_missing_grows_with_the_load_where_the_recordings_say_so():
    """Large tests are deeper by 2 % than the law with the parameters that the small ones have; or none is."""

    def of_load(condition, replicate):
        return 0.02 * cone(condition.protocol, **TRUTH) * (condition.name == "c")

    def trend(effect, seed):
        fit = fitted(problem(recordings(np.random.default_rng(seed), effect, replicates=6, site=0.002)))
        true = np.concatenate([cone(condition.protocol, **TRUTH) for condition in CONDITIONS])
        trends = missing_physics(replace(fit, curve=true, tangent=0.0 * fit.tangent))["trends"]
        return {row["by"]: row for row in trends}["load"]

    found = trend(of_load, 2)
    assert (found["from"], found["to"]) == (0.2, 4.0)
    assert found["p_value"] < 1e-3
    assert found["residual_to"] - found["residual_from"] == pytest.approx(0.02, abs=0.006)
    without = [trend(lambda c, r: 0.0, seed)["p_value"] for seed in range(3, 13)]
    assert min(without) > 1e-3
    assert max(without) > 0.1


def test_segments_of_a_trapezoid():
    found = segments(trapezoid(1.0, 10, 20, 10, points=40))
    assert {name: int(where.sum()) for name, where in found.items()} == {"loading": 10, "hold": 20, "unloading": 10}
    assert list(segments(trapezoid(1.0, 10, 0, 10, points=40))) == ["loading", "unloading"]


def test_without_replicates_the_noise_comes_from_the_residual():
    rng = np.random.default_rng(13)
    task = problem(recordings(rng, replicates=1))
    first = fitted(task)
    noise = noise_of(task, (), first.residual, 0.01)
    assert not noise.replicated
    rough = noise.sigma * np.sqrt(2 * (1 - noise.autocorrelation))
    assert np.median(rough) == pytest.approx(np.sqrt(2 * 0.2), rel=0.4)


def test_the_base_model_of_single_recordings_stays_where_they_were_calibrated():
    """The discrepancy leaves the likelihood so flat that a search of its own would end elsewhere."""
    task = problem(recordings(np.random.default_rng(23), replicates=1))
    base = search_of(task).base.fit
    found = base.coordinates.named(base.z)
    assert found == pytest.approx({name: TRUTH[name] for name in found})


def test_single_recordings_do_not_take_a_strong_effect_for_noise():
    planted = recordings(np.random.default_rng(17), lambda c, r: 60.0 * c.protocol.sample_load, replicates=1)
    assert search_of(problem(planted)).base.p_value < 0.01


def test_single_recordings_measure_all_explanations_by_the_quietest_noise():
    """A fit that leaves the zero offset in leaves more, and must not allow itself more noise."""
    task = problem(recordings(np.random.default_rng(19), lambda c, r: -90.0, replicates=1))
    search = search_of(task)
    base = search.base.fit
    moved, framed = (search.joined(base, key) for key in ("zero_offset", "frame_compliance"))
    assert root_mean_square(base.residual) > 10.0 * root_mean_square(moved.residual)
    quietest = noise_of(task, (), moved.residual, 0.01).sigma
    assert base.errors.noise.sigma == pytest.approx(quietest, rel=0.05)
    assert framed.errors.noise is base.errors.noise


def test_a_set_whose_search_stopped_early_is_fitted_again_where_a_larger_one_ended():
    """The larger one holds a frame that does nothing, and so makes way for the drift alone."""
    task = problem(recordings(np.random.default_rng(8), lambda c, r: 0.5 * c.protocol.sample_time))
    search = search_of(task)
    drift = search.candidate(search.joined(search.base.fit, "thermal_drift"))
    away = search.fitted(("thermal_drift",), [drift.fit.z + 0.05], drift.fit.curve)
    stopped = replace(drift, fit=replace(drift.fit, curve=drift.fit.curve + 5.0, z=away.z))
    larger = search.candidate(search.joined(drift.fit, "frame_compliance"))
    found = Explanations(3)
    for each in (search.base, stopped, larger):
        found.add(each)
    found.fitted = {m: c for m, c in found.fitted.items() if c is not search.base} | {frozenset(): search.base}
    found.fitted[frozenset(larger.fit.explanation)] = replace(larger, fit=replace(larger.fit, converged=True))
    _complete(search, found, lambda said: None)
    again = found.fitted[frozenset({"thermal_drift"})]
    assert again.fit.log_evidence == pytest.approx(drift.fit.log_evidence, abs=0.5)


def test_one_kind_of_test_names_no_effect_but_the_instruments():
    def named(count, replicated, *explanation):
        return sufficient_to_identify(
            SimpleNamespace(conditions=CONDITIONS[:count], replicated=replicated), explanation
        )

    assert named(2, True, "size_effect", "thermal_drift")
    assert named(1, True, "thermal_drift", "frame_compliance")
    assert not named(1, True, "size_effect", "thermal_drift")
    assert not named(2, False, "thermal_drift")


def test_what_lies_outside_its_range_is_said():
    """The modulus is 1, beyond a range that ends at 0.9; a frame that gives 1.5 depth / load is beyond 0.3."""
    inside = problem(recordings(np.random.default_rng(3)))
    assert outside(fitted(inside)) == []
    narrow = replace(MATERIAL, free=[replace(MATERIAL.free[0], upper=0.9), MATERIAL.free[1]])
    ((quantity, value),) = outside(fitted(replace(inside, forward=replace(inside.forward, coordinates=narrow))))
    assert quantity.name == "modulus" and value == pytest.approx(1.0, rel=0.05)
    unit = SCALE.depth / SCALE.load
    soft = problem(recordings(np.random.default_rng(3), lambda c, r: 1.5 * unit * c.protocol.sample_load))
    found = {quantity.name: value for quantity, value in outside(fitted(soft, ("frame_compliance",)))}
    assert found["frame_compliance.compliance"] == pytest.approx(1.5 * unit, rel=0.05)
    wide = replace(soft, scale=replace(SCALE, stated={"frame_compliance": {"compliance": [0.0, 4.0 * unit]}}))
    assert outside(fitted(wide, ("frame_compliance",))) == []
