"""Diagnosis on recordings whose noise and effects are known exactly; base model and effects are closed forms."""

from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import toeplitz

from palpate.calibration import Observation
from palpate.calibration.noise import model_covariance
from palpate.calibration.space import Space
from palpate.config import Condition
from palpate.diagnosis.correction import Correction
from palpate.diagnosis.covariance import errors, noise_of, solver_scatter, varying
from palpate.diagnosis.design import thinned
from palpate.diagnosis.detect import examine
from palpate.diagnosis.diagnose import _resumed
from palpate.diagnosis.edges import at_edges
from palpate.diagnosis.fit import solve, starting_points
from palpate.diagnosis.locate import location
from palpate.diagnosis.noise_fit import Replicates, contrasts, fit_noise
from palpate.diagnosis.problem import Problem
from palpate.diagnosis.search import Candidate, Search
from palpate.diagnosis.segments import segments
from palpate.diagnosis.similarity import similarity
from palpate.diagnosis.standing import may_be_named, without_idle
from palpate.mechanisms import MECHANISMS, Scale
from palpate.protocol import trapezoid

CHALLENGE = Path(__file__).parents[1] / "config" / "challenge.yaml"
RECORD_ONLY = ["frame_compliance", "thermal_drift", "zero_offset"]
CONDITIONS = tuple(
    Condition(name, "calibrate", trapezoid(load, rise, hold, rise, points=60))
    for name, load, rise, hold in [("a", 1.0, 10, 0), ("b", 1.0, 40, 20), ("c", 4.0, 20, 20), ("d", 0.2, 20, 0)]
)
SCALE = Scale(depth=1000, load=4.0, modulus=3.0, duration=100, loading_time=10, half_angle=70.3, pressure=0.2)


ONES = {c.name: np.ones(60) for c in CONDITIONS}


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """Linear viscoelastic cone: h^2 = c J*P with a modulus and a viscosity, exact for loading, good enough here."""

    condition: Condition

    def predict(self, x):
        time, load = self.condition.protocol.sample_time, self.condition.protocol.sample_load
        flow = np.cumsum(load * np.diff(time, prepend=0.0))
        x = np.atleast_2d(x)
        return 500.0 * np.sqrt(load / x[:, :1] + x[:, 1:] * flow + 0.05)

    evaluate = predict

    def jacobian(self, x):
        steps = 1e-6 * np.eye(2)
        return np.array([(self.predict(x + s) - self.predict(x - s))[0] / 2e-6 for s in steps]).T

    @property
    def loo_error_(self):
        return np.zeros((1, len(self.condition.protocol.sample_time)))


def recordings(rng, effect=lambda c, r: 0.0, replicates=3, sigma=1.0, memory=0.8, site=0.01):
    observed = {}
    for condition in CONDITIONS:
        time = condition.protocol.sample_time
        point = sigma**2 * toeplitz(memory ** np.arange(len(time)))
        depth = ClosedForm(condition).predict([1.0, 0.01])[0]
        rows = [
            depth * (1 + site * rng.standard_normal())
            + effect(condition, r)
            + rng.multivariate_normal(np.zeros(len(time)), point, method="cholesky")
            for r in range(replicates)
        ]
        observed[condition.name] = Observation(time, np.array(rows), "calibrate")
    return observed


def problem(observed):
    base = {c.name: ClosedForm(c) for c in CONDITIONS}
    space = Space({"modulus": (0.7, 1.4), "fluidity": (0.0, 0.03)})
    return Problem(CONDITIONS, observed, space, base, {c.name: {} for c in CONDITIONS}, ONES, SCALE)


def weighed(task, explanation, residual):
    """Errors of the mean curves; without replicates with the noise of a `residual`."""
    return errors(task, explanation, residual, noise_of(task, varying(explanation), residual, 0.01), 0.003)


def fitted(task, explanation=(), start=None):
    start = np.full(task.dimensions(explanation), 0.5) if start is None else start
    found = weighed(task, explanation, np.zeros(len(task.mean)))
    return solve(task, explanation, found, [start])


def test_evidence_is_the_likelihood_averaged_over_the_ranges():
    """The even prior has density one: summed up on a grid over five standard deviations about the best fit."""
    fit = fitted(problem(recordings(np.random.default_rng(2))))
    spread = 5.0 * np.sqrt(np.diag(fit.posterior))
    axes = [np.linspace(z - s, z + s, 61) for z, s in zip(fit.z, spread, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    assert points.min() > 0.0 and points.max() < 1.0
    white = fit.whiten((fit.problem.mean - fit.curves(points)).T)
    likelihood = fit.errors.noise.log_likelihood - 0.5 * np.sum(white**2, axis=0) - fit.log_volume
    cell = np.prod([axis[1] - axis[0] for axis in axes])
    assert fit.log_evidence == pytest.approx(
        np.log(cell * np.exp(likelihood - likelihood.max()).sum()) + likelihood.max(), abs=0.05
    )


def p_value(task, rng):
    return examine(fitted(task), RECORD_ONLY, rng, 400, 0.01)


def learnt(predict):
    return SimpleNamespace(predict=predict)


def test_what_can_be_derived_is_made_of_the_sum_of_what_was_learnt():
    """A delay acts on the curve of a tip that is rounded, too: nothing of the two is left to the forward model."""
    task = problem(recordings(np.random.default_rng(1)))
    grown = {c.name: np.linspace(30.0, 10.0, 60) for c in CONDITIONS}
    rounding = {name: learnt(lambda points, g=g: points[:, -1:] * g) for name, g in grown.items()}
    rest = learnt(lambda points: np.zeros((len(points), 60)))
    task = replace(task, effects={name: {"tip_rounding": rounding[name], "controller_lag": rest} for name in grown})
    z = np.array([[0.5, 0.5, 0.7, 0.4]])
    curves = task.split(task.curves(("tip_rounding", "controller_lag"), z)[0])
    lag = task.amplitudes(("tip_rounding", "controller_lag"), z[0])["controller_lag"]["lag"]
    for condition in CONDITIONS:
        time = condition.protocol.sample_time
        rounded = ClosedForm(condition).predict(task.space.physical(z[:, :2]))[0] + 0.7 * grown[condition.name]
        delayed = np.sqrt(np.interp(time - lag, np.append(0.0, time), np.append(0.0, rounded) ** 2))
        assert curves[condition.name] == pytest.approx(delayed)


def test_an_effect_errs_by_the_same_part_everywhere():
    rest = {c.name: learnt(lambda points: np.full((len(points), 60), 40.0)) for c in CONDITIONS}
    effects = {name: {"film_on_substrate": effect} for name, effect in rest.items()}
    task = replace(problem(recordings(np.random.default_rng(1))), effects=effects)
    scatter = solver_scatter(task, ("film_on_substrate",), np.full(4, 0.5))
    assert scatter == pytest.approx(
        np.full(scatter.shape, (40.0 * MECHANISMS["film_on_substrate"].solver_scatter) ** 2)
    )


def test_the_error_of_grid_convergence_is_one_factor_on_all_curves():
    """A depth that is off by a common factor costs what that factor costs, however long the curves are."""
    task = problem(recordings(np.random.default_rng(1)))
    covariance = model_covariance(task.split(task.mean), 0.003)
    assert covariance == pytest.approx(np.outer(0.003 * task.mean, 0.003 * task.mean))
    off = 0.006 * task.mean
    assert off @ np.linalg.solve(covariance + 1e-6 * np.eye(len(off)), off) == pytest.approx(4.0, rel=1e-3)


def test_the_fine_mesh_takes_the_base_models_factor_whatever_acts():
    task = problem(recordings(np.random.default_rng(1)))
    factors = {c.name: np.linspace(1.002, 1.001, 60) for c in CONDITIONS}
    finer, z = replace(task, refinement=factors), np.array([[0.5, 0.5]])
    ratio = task.split(finer.curves((), z)[0] / task.curves((), z)[0])
    for condition in CONDITIONS:
        assert ratio[condition.name] == pytest.approx(factors[condition.name])
        assert np.array_equal(finer.mesh_factor(condition), factors[condition.name])
    assert finer.mesh_factor(replace(CONDITIONS[0], name="not learnt")) == pytest.approx(1.0015)


def test_effects_are_learnt_at_small_loads_in_full():
    for condition in CONDITIONS:
        short, protocol = thinned(condition.protocol), condition.protocol
        small = protocol.sample_time[protocol.sample_load < 0.2 * protocol.max_load]
        assert np.isin(small, short.sample_time).all()
        assert len(short.sample_time) < 0.6 * len(protocol.sample_time)


def test_a_correction_found_where_a_fit_is_hopeless_is_not_carried_on():
    rng = np.random.default_rng(2)
    task = problem(recordings(rng, lambda c, r: 0.5 * c.protocol.sample_time))
    study = SimpleNamespace(diagnosis={"bootstrap": 200}, calibration={"site_scatter": 0.01, "solver_error": 0.003})
    search = Search(study, task, RECORD_ONLY, rng)
    wrong = Correction(np.full(2, 0.5), np.full(len(task.mean), 40.0), np.zeros((len(task.mean), 2)))
    base = replace(search.base(), correction=wrong)
    assert base.misfit > 3.0 * len(base.residual)
    drifting = search.extended(base, "thermal_drift")
    assert not drifting.correction.value.any()
    assert drifting.misfit < 1.5 * len(base.residual)


def test_noise_is_recovered_from_replicates():
    rng = np.random.default_rng(3)
    time = np.linspace(1, 100, 80)
    sets = []
    for height in (300.0, 500.0, 800.0, 1200.0):
        depth = height * np.sqrt(time / 100)
        covariance = 1.5**2 * toeplitz(0.7 ** np.arange(80)) + 0.02**2 * np.outer(depth, depth)
        rows = rng.multivariate_normal(depth, covariance, size=6, method="cholesky")
        parts = {"site": np.outer(depth, depth), "wander": np.minimum.outer(time, time)}
        sets.append(Replicates(contrasts(rows), np.eye(80), parts, height))
    found = fit_noise(sets, {"site": 1e-4, "wander": 1e-4}, True, {})
    assert found.sigma == pytest.approx(1.5, rel=0.15)
    assert found.memory == pytest.approx(0.7, abs=0.1)
    assert np.sqrt(found.variances["site"]) == pytest.approx(0.02, rel=0.4)
    assert np.sqrt(found.variances["wander"]) < 0.1


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
    rng = np.random.default_rng(5)
    task = problem(recordings(rng, effect))
    base = fitted(task)
    assert examine(base, RECORD_ONLY, rng, 400, 0.01) < 0.01
    fits = {}
    for other in RECORD_ONLY:
        start = starting_points(base, other, 1)[0]
        fits[other] = fitted(task, (other,), start)
    assert max(fits, key=lambda name: fits[name].log_evidence) == key
    best = fits[key]
    (estimate,) = task.amplitudes((key,), best.z)[key].values()
    assert estimate == pytest.approx(truth, rel=0.15)
    assert examine(best, RECORD_ONLY, rng, 400, 0.01) > 0.01


def test_an_effect_in_no_library_leaves_something_behind():
    rng = np.random.default_rng(7)
    task = problem(recordings(rng, lambda c, r: 12.0 * np.sin(2 * np.pi * c.protocol.sample_time / 9.0)))
    base = fitted(task)
    for key in RECORD_ONLY:
        wider = fitted(task, (key,), starting_points(base, key, 1)[0])
        assert examine(wider, RECORD_ONLY, rng, 400, 0.01) < 0.01


def test_location_points_at_the_part_that_differs():
    def late_hold(condition, replicate):
        where = segments(condition.protocol).get("hold", np.zeros(60, dtype=bool))
        return 10.0 * where * (condition.name == "b")

    first = location(fitted(problem(recordings(np.random.default_rng(2), late_hold))))[0]
    assert (first["condition"], first["segment"]) == ("b", "hold")
    assert first["q_value"] < 0.05
    assert first["residual_nm"] > 0


def pair_of_tests(compliance, replicates):
    """Return two tests of one shape, by a closed form that obeys the law but for its constant and a compliant frame."""
    pair = [
        Condition(name, "calibrate", trapezoid(load, 20, 10, 20, points=60)) for name, load in (("p", 1.0), ("q", 4.0))
    ]
    rng, observed = np.random.default_rng(4), {}
    for condition in pair:
        time, load = condition.protocol.sample_time, condition.protocol.sample_load
        flow = np.cumsum(load * np.diff(time, prepend=0.0))
        depth = 500 * np.sqrt(load + 0.01 * flow) + compliance * load
        rows = [depth * (1 + 0.01 * rng.standard_normal()) + rng.standard_normal(60) for _ in range(replicates)]
        observed[condition.name] = Observation(time, np.array(rows), "calibrate")
    base, ones = {c.name: ClosedForm(c) for c in pair}, {c.name: np.ones(60) for c in pair}
    space = Space({"modulus": (0.7, 1.4), "fluidity": (0.0, 0.03)})
    return Problem(tuple(pair), observed, space, base, {c.name: {} for c in pair}, ones, SCALE)


def test_the_sharp_tips_law_notices_an_instrument_but_no_material():
    quiet, framed = (similarity(fitted(pair_of_tests(compliance, 4)))[0] for compliance in (0.0, 8.0))
    assert quiet["p_value"] > 0.01
    assert framed["p_value"] < 1e-3
    assert framed["difference_percent"] > 0.5


def test_the_law_of_a_sharp_tip_is_tested_without_replicates_too():
    (row,) = similarity(fitted(pair_of_tests(8.0, 1)))
    assert 0.0 <= row["p_value"] <= 1.0


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
    rough = noise.sigma * np.sqrt(2 * (1 - noise.memory))
    assert np.median(rough) == pytest.approx(np.sqrt(2 * 0.2), rel=0.4)


def test_single_recordings_do_not_take_a_strong_effect_for_noise():
    rng = np.random.default_rng(17)
    task = problem(recordings(rng, lambda c, r: 60.0 * c.protocol.sample_load, replicates=1))
    first = fitted(task)
    found = weighed(task, (), first.residual)
    again = solve(task, (), found, [first.z])
    assert examine(again, RECORD_ONLY, rng, 400, 0.01) < 0.01


def test_single_recordings_measure_all_explanations_by_the_quietest_noise():
    """A fit that leaves the zero offset in leaves more, and would allow itself more noise."""
    rng = np.random.default_rng(19)
    task = problem(recordings(rng, lambda c, r: -60.0, replicates=1))
    settings = {"bootstrap": 200, "largest_set": 2}
    study = SimpleNamespace(diagnosis=settings, calibration={"site_scatter": 0.01, "solver_error": 0.003})
    search = Search(study, task, RECORD_ONLY, rng)
    base = search.base()
    moved, framed = (search.extended(base, key) for key in ("zero_offset", "frame_compliance"))
    own = [noise_of(task, (), fit.residual, 0.01).sigma for fit in (base, moved)]
    assert np.median(own[0]) > 1.2 * np.median(own[1])
    assert base.errors.noise.sigma == pytest.approx(own[1], rel=0.01)
    assert framed.errors.noise is base.errors.noise


def test_a_set_whose_search_stopped_early_goes_on_where_a_larger_one_ended(monkeypatch):
    """The larger one holds a frame that does nothing, and so makes way for the drift alone."""
    rng = np.random.default_rng(8)
    task = problem(recordings(rng, lambda c, r: 0.5 * c.protocol.sample_time))
    study = SimpleNamespace(diagnosis={"bootstrap": 200}, calibration={"site_scatter": 0.01, "solver_error": 0.003})
    search = Search(study, task, RECORD_ONLY, rng)
    drift = search.extended(search.base(), "thermal_drift")
    stopped = Candidate(replace(drift, z=drift.z + 0.02), p_value=0.001, confirmed=True)
    larger = search.extended(drift, "frame_compliance")
    start = search.without(larger, "frame_compliance")
    assert start.explanation == ("thermal_drift",)
    idle = task.effect("frame_compliance", larger.z[:2], larger.z[3:])[0]
    np.testing.assert_allclose(start.curve, larger.curve - idle)
    monkeypatch.setattr(Search, "refined", lambda self, fit: Candidate(fit, p_value=1.0, confirmed=True))
    standing = [Candidate(larger, p_value=1.0, confirmed=True)]
    (resumed,) = _resumed(search, standing, [*standing, stopped], lambda line: None)
    assert resumed.fit.log_likelihood > stopped.fit.log_likelihood
    assert without_idle(standing, [resumed]) == []
    another = Candidate(search.extended(drift, "zero_offset"), p_value=1.0, confirmed=True)
    assert len(_resumed(search, [*standing, another], [*standing, another, stopped], lambda line: None)) == 1
    found_well = Candidate(drift, p_value=1.0, confirmed=True)
    assert _resumed(search, standing, [*standing, found_well], lambda line: None) == []


def test_one_kind_of_test_names_no_effect_but_the_instruments():
    def named(count, replicated, *explanation):
        return may_be_named(SimpleNamespace(conditions=CONDITIONS[:count], replicated=replicated), explanation)

    assert named(2, True, "size_effect", "thermal_drift")
    assert named(1, True, "thermal_drift", "frame_compliance")
    assert not named(1, True, "size_effect", "thermal_drift")
    assert not named(2, False, "thermal_drift")


def test_what_lies_at_the_edge_of_the_search_is_said():
    """The modulus is 1, beyond a grid that ends at 0.9; a frame that gives 1.5 depth / load is beyond 0.3."""
    inside = problem(recordings(np.random.default_rng(3)))
    assert at_edges(fitted(inside)) == []
    small = replace(inside, space=Space({"modulus": (0.7, 0.9), "fluidity": (0.0, 0.03)}))
    assert "modulus 0.9" in at_edges(fitted(small))
    unit = SCALE.depth / SCALE.load
    soft = problem(recordings(np.random.default_rng(3), lambda c, r: 1.5 * unit * c.protocol.sample_load))
    assert f"frame_compliance.compliance {0.3 * unit:.3g}" in at_edges(fitted(soft, ("frame_compliance",)))
    wide = replace(soft, scale=replace(SCALE, stated={"frame_compliance": {"compliance": [0.0, 4.0 * unit]}}))
    assert at_edges(fitted(wide, ("frame_compliance",))) == []


@pytest.mark.parametrize(
    ("key", "own", "said"),
    [("tip_angle", [0.0], ["half_angle"]), ("tip_rounding", [0.0], []), ("second_voigt", [0.0, 0.5, 0.0], ["time"])],
)
def test_an_effect_that_does_not_vanish_at_a_lower_end_may_want_to_go_further(key, own, said):
    fit = replace(
        fitted(problem(recordings(np.random.default_rng(3)))), explanation=(key,), z=np.array([0.5, 0.5, *own])
    )
    found = at_edges(fit)
    assert len(found) == len(said) and all(word in name for word, name in zip(said, found, strict=True))
