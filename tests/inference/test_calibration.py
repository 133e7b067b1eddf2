"""Calibration on families with a known answer: recovery, coverage, noise, what the data do not fix."""

import json

import numpy as np
import pytest

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.configuration.settings import CalibrationSettings
from palpate.data.measures import error_measures, mean_square, relative
from palpate.data.observation import Observation
from palpate.errors import InputError, PalpateError
from palpate.inference.calibrate import calibrate
from palpate.inference.estimates import intervals
from palpate.inference.fitting import Fitter
from palpate.inference.least_squares import Misfit
from palpate.inference.problem import Problem
from palpate.inference.search_state import StoppingCriteria
from palpate.inference.trust_region import continued, descend
from palpate.mechanisms import Scale
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.study.protocol import trapezoid
from studies.thesis.surrogate_forward import SurrogateForward

PROTOCOL = trapezoid(1.0, 0.5, 0, 0.5, points=50)
T = PROTOCOL.sample_time
SCALE = Scale(depth=500, load=1.0, modulus=3.0, duration=1.0, loading_time=0.5, half_angle=70.3, pressure=0.2)
QUICK = CalibrationSettings(population=40, generations=30, subpopulations=2, solver_error=0.0)


class Family:
    """Depth 500 (a t^b) (1 + 0 c) + bias, with exact slopes; c does nothing."""

    def __init__(self, rate=1.0, bias=0.0):
        self.rate, self.bias = rate, bias

    def predict(self, X):
        a, b = np.asarray(X)[:, :2].T[:, :, None]
        return 500.0 * a * self.rate**0.3 * T ** (b * self.rate) + self.bias * T

    def jacobian(self, x):
        depth = self.predict(x[None])[0] - self.bias * T
        return np.column_stack([depth / x[0], depth * self.rate * np.log(T), np.zeros((len(T), len(x) - 2))])


FAMILIES = {"slow": Family(), "fast": Family(0.5)}
BOUNDS = {"a": (0.5, 1.5), "b": (0.2, 0.9), "c": (0.0, 1.0), "d": (0.34, 0.34)}
TRUTH = {"a": 1.1, "b": 0.45, "c": 0.2, "d": 0.34}


def calibrated(data, forward=None, surrogates=None, bounds=BOUNDS, settings=QUICK, seed=0, report=lambda line: None):
    """Calibrate on a forward model, by default on surrogates within their bounds."""
    surrogates = surrogates or FAMILIES
    conditions = tuple(Condition(name, "calibrate", PROTOCOL) for name in data if data[name].role == "calibrate")
    problem = Problem(conditions, data, forward or SurrogateForward(surrogates, bounds), SCALE)
    return calibrate(problem, surrogates, bounds, rng=np.random.default_rng(seed), settings=settings, report=report)


def recordings(rng, clean, replicates=3, sigma=1.0, rho=0.7, site=0.01):
    n = len(clean)
    factor = np.linalg.cholesky(sigma**2 * rho ** np.abs(np.subtract.outer(np.arange(n), np.arange(n))))
    return (1 + site * rng.standard_normal((replicates, 1))) * clean + rng.standard_normal((replicates, n)) @ factor.T


def stacked(parts):
    return np.concatenate([parts[name] for name in FAMILIES])


def observed(rng, families=FAMILIES, **options):
    x = np.array([list(TRUTH.values())])
    return {name: Observation(T, recordings(rng, f.predict(x)[0], **options)) for name, f in families.items()}


@pytest.mark.parametrize("aggregated", [False, True])
@pytest.mark.parametrize("objective", ["mean_square", "relative"])
def test_recovers_the_truth_and_says_what_the_data_do_not_fix(aggregated, objective):
    settings = QUICK.model_copy(
        update={"objective": objective, "strategy": "aggregate" if aggregated else "nsga2", "solver_error": 0.003}
    )
    found = calibrated(observed(np.random.default_rng(5)), settings=settings)
    for name in "ab":
        parameter = found.parameters[name]
        assert parameter.identified and parameter.lower < TRUTH[name] < parameter.upper
        assert parameter.estimate == pytest.approx(TRUTH[name], rel=0.03)
    free, held = found.parameters["c"], found.parameters["d"]
    assert not free.identified and free.upper - free.lower > 0.9
    assert held.held and not held.identified and held.estimate == held.lower == held.upper == 0.34
    assert 0.3 < found.misfit_ratio < 2.0
    assert len(found.pareto["objectives"]) == (1 if aggregated else 2)


def test_reproducible_from_its_seed_and_written_as_json():
    data = observed(np.random.default_rng(5))
    texts = [json.dumps(calibrated(data, seed=7).to_mapping(condition_set="all"), allow_nan=False) for _ in range(2)]
    assert texts[0] == texts[1]
    read = json.loads(texts[0])
    assert set(read["parameters"]["a"]) >= {"estimate", "lower", "upper", "identified"}
    assert set(read["conditions"]["slow"]) >= {"rmse_nm", "r2", "mean_abs_error_nm", "percent_error", "role"}
    assert read["seed"] == 7 and read["condition_set"] == "all"


def test_clean_data_give_the_truth_itself():
    x = np.array([list(TRUTH.values())])
    found = calibrated({name: Observation(T, f.predict(x)) for name, f in FAMILIES.items()})
    assert [found.values[n] for n in "ab"] == pytest.approx([TRUTH[n] for n in "ab"], rel=1e-5)
    assert found.conditions["slow"]["r2"] == pytest.approx(1.0)


def test_an_estimate_on_a_bound_is_not_identified():
    found = calibrated(observed(np.random.default_rng(1)), bounds=BOUNDS | {"a": (0.5, 1.0)})
    assert found.parameters["a"].at_bound and not found.parameters["a"].identified


def test_validation_conditions_are_judged_but_never_fitted():
    data = observed(np.random.default_rng(5))
    absurd = {"check": Observation(T, 3.0 * data["slow"].response, role="validate")}
    surrogates = FAMILIES | {"check": Family()}
    with_it, without = (calibrated(chosen, surrogates=surrogates) for chosen in (data | absurd, data))
    assert with_it.values == without.values
    assert with_it.conditions["check"]["role"] == "validate" and with_it.conditions["check"]["rmse_nm"] > 100


class Forward:
    """Families as a forward model, which fails at a beyond an edge and under some conditions."""

    def __init__(self, families=FAMILIES, names=tuple(FAMILIES), edge=np.inf, fails=()):
        self.families, self.names, self.edge, self.fails = families, names, edge, fails
        free = [Coordinate(n, *BOUNDS[n], 0.0, 50.0, logarithmic=n == "a") for n in "abc"]
        self.coordinates = Coordinates(free, {"d": 0.34})

    def under(self, names):
        return Forward(self.families, names, self.edge, self.fails)

    @property
    def refinements(self):
        return {}

    def reanchored(self, u):
        return self

    def refined(self, u):
        return None

    def extrapolated(self, u):
        return None

    def amplitudes(self, u):
        return {}

    def points_per_batch(self, u):
        return 4

    def thinned(self):
        return self, {name: np.ones(len(T), dtype=bool) for name in self.names}

    def curves(self, points):
        return [found if isinstance(found, str) else found[0] for found in self.tangents(points)]

    def tangents(self, points):
        found = []
        for u in points:
            x = np.array([self.coordinates.named(u)[name] for name in BOUNDS])
            failing = [name for name in self.names if name in self.fails or x[0] > self.edge]
            curves = {name: self.families[name].predict(x[None])[0] for name in self.names if name not in self.fails}
            by = np.array([each.slope(place) for each, place in zip(self.coordinates.free, u, strict=True)])
            slopes = {n: self.families[n].jacobian(x)[:, :3] * by for n in curves}
            found.append(f"{failing[0]}: no equilibrium" if failing else (curves, slopes))
        return found


def test_the_forward_model_removes_the_error_of_the_surrogate():
    """Both its bias and its slope in the parameters."""
    data = observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0)
    wrong = {"slow": Family(1.1, bias=15.0), "fast": Family(0.5, bias=-5.0)}
    surrogate_only, found = (calibrated(data, forward, wrong) for forward in (None, Forward()))
    assert abs(surrogate_only.values["b"] - TRUTH["b"]) > 5e-3
    assert abs(found.on_surrogates["b"] - TRUTH["b"]) > 5e-3
    assert found.values["b"] == pytest.approx(TRUTH["b"], abs=1e-4)
    assert found.conditions["slow"]["rmse_nm"] < 0.2
    assert found.converged


def test_a_fit_ends_on_curves_of_finer_meshes_with_slopes_that_are_about_right():
    """The model errs by less than the recordings tell, and by more than the estimate may."""

    class Finer:
        def curves(self, points):
            return Forward().curves(points)

        def consistent(self, u, curves, slopes):
            return Forward()

    class Coarse(Forward):
        def __init__(self):
            super().__init__({"slow": Family(1.01), "fast": Family(0.5)})

        def extrapolated(self, u):
            return Finer(), Forward().curves([u])[0], self.tangents([u])[0][1]

    data = observed(np.random.default_rng(0), sigma=3.0, rho=0.0, site=0.0)
    usual = calibrated(data, Forward(Coarse().families))
    settled, true = calibrated(data, Coarse()), calibrated(data, Forward())
    width = true.parameters["b"].upper - true.parameters["b"].lower
    assert abs(usual.values["b"] - true.values["b"]) > 0.25 * width
    assert settled.converged and abs(settled.values["b"] - true.values["b"]) < 0.02 * width


def test_an_estimate_may_lie_outside_its_range():
    truth = TRUTH | {"a": 2.2}
    x = np.array([list(truth.values())])
    rng = np.random.default_rng(1)
    found = calibrated({n: Observation(T, recordings(rng, f.predict(x)[0])) for n, f in FAMILIES.items()}, Forward())
    a = found.parameters["a"]
    assert found.on_surrogates["a"] == pytest.approx(BOUNDS["a"][1], rel=1e-2)
    assert a.lower < 2.2 < a.upper and a.outside and not a.at_bound and not a.identified
    assert not found.parameters["b"].outside


def test_a_search_stops_where_the_forward_model_fails():
    data = observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0)
    assert 0.9 < calibrated(data, Forward(edge=1.05)).values["a"] <= 1.05


def test_a_search_goes_on_by_secants_where_curves_are_known_but_no_derivatives():

    class Rough(Forward):
        def curves(self, points):
            return Forward().curves(points)

        def tangents(self, points):
            rough = [self.coordinates.named(u)["a"] > 1.0 for u in points]
            return ["unknown" if r else found for r, found in zip(rough, super().tangents(points), strict=True)]

    data, model = observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0), Rough()
    measured = np.concatenate([item.mean for item in data.values()])
    misfit = Misfit(measured, np.eye(2 * len(T)), stacked, model.coordinates)
    begun = model.coordinates.scaled({"a": 0.7, "b": 0.5, "c": 0.5})
    found = descend(misfit, model, [begun], StoppingCriteria(40, 0.02, exact=True))
    assert model.coordinates.named(found.u)["a"] == pytest.approx(TRUTH["a"], rel=1e-3)
    assert found.converged


@pytest.mark.parametrize(("departure", "explained"), [(0.0, True), (3.0, False)])
def test_a_search_that_cannot_come_to_the_noise_is_given_up(departure, explained):
    """By curves that depart in a shape that no parameter has; else it ends where it would without the limit."""
    data, model = observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0), Forward()
    measured = np.concatenate([item.mean + departure * np.sin(9.0 * T) for item in data.values()])
    misfit = Misfit(measured, 0.05**2 * np.eye(2 * len(T)), stacked, model.coordinates)
    begun = model.coordinates.scaled({"a": 0.7, "b": 0.5, "c": 0.5})
    limited, free = (
        descend(misfit, model, [begun], StoppingCriteria(40, 0.02, reach=r)) for r in (3.0 * len(T), np.inf)
    )
    assert limited.converged == explained
    assert free.converged
    assert (len(limited.path) == len(free.path)) == explained


def test_a_search_that_gains_little_ends_whatever_its_slopes_predict():
    """By derivatives that are a hundred times too steep, so that steps are far too short."""

    class Misleading(Forward):
        def tangents(self, points):
            asked.append(points)
            found = super().tangents(points)
            return [(curves, {n: 100.0 * of for n, of in slopes.items()}) for curves, slopes in found]

        def curves(self, points):
            return Forward().curves(points)

    def needed(least_gain):
        asked.clear()
        descend(misfit, Misleading(), [begun], StoppingCriteria(40, 0.02, exact=True, least_gain=least_gain))
        return len(asked)

    asked, data = [], observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0)
    coordinates = Forward().coordinates
    measured = np.concatenate([item.mean for item in data.values()])
    misfit = Misfit(measured, np.eye(2 * len(T)), stacked, coordinates)
    begun = coordinates.scaled({"a": 0.7, "b": 0.5, "c": 0.5})
    assert needed(1e9) < needed(0.0)


def test_a_search_with_all_samples_goes_on_where_the_model_did_not_fail():
    """The last place of the search with few samples is one at which the other model fails."""
    data = observed(np.random.default_rng(0), sigma=0.05, rho=0.0, site=0.0)
    measured = np.concatenate([item.mean for item in data.values()])
    model = Forward()
    misfit = Misfit(measured, np.eye(2 * len(T)), stacked, model.coordinates)
    begun = model.coordinates.scaled({"a": 0.7, "b": 0.5, "c": 0.5})
    way = descend(misfit, model, [begun], StoppingCriteria(40, 0.02, exact=True))
    assert model.coordinates.named(way.u)["a"] > 1.05
    found = continued(misfit, Forward(edge=1.05), way, StoppingCriteria(40, 0.02))
    assert 0.9 < model.coordinates.named(found.u)["a"] <= 1.05


def test_a_forward_model_that_fails_everywhere_is_told():
    with pytest.raises(PalpateError, match="no equilibrium"):
        calibrated(observed(np.random.default_rng(0)), Forward(edge=0.0))


def test_nothing_is_identified_where_the_fit_fails():
    shape = 300.0 * (1.0 + np.sin(9.0 * T))
    rng = np.random.default_rng(2)
    found = calibrated({name: Observation(T, recordings(rng, shape)) for name in FAMILIES}, Forward())
    assert not any(entry.identified for entry in found.parameters.values())


def test_a_held_out_condition_that_cannot_be_simulated_is_told_and_left_out():
    data = observed(np.random.default_rng(5))
    data |= {"check": Observation(T, data["slow"].response, role="validate")}
    told = []
    found = calibrated(data, Forward(fails=("check",)), report=told.append)
    assert set(found.simulated_curves) == set(found.conditions) == set(FAMILIES)
    assert told[-1] == "check has no errors: no equilibrium"


class Linear:
    """Depth 400 t + two shapes, linear in two parameters."""

    def __init__(self, time, scale):
        self.basis = scale * np.column_stack([time, time**2, np.sin(4 * time)]) * [400.0, 60.0, 20.0]

    def predict(self, X):
        return self.basis[:, 0] + np.asarray(X) @ self.basis[:, 1:].T

    def jacobian(self, x):
        return self.basis[:, 1:]


def test_intervals_cover_the_truth_as_often_as_they_say():
    rng, truth, trials, hits = np.random.default_rng(0), np.array([0.4, 0.55]), 300, np.zeros(2)
    few = trapezoid(1.0, 0.5, 0, 0.5, points=20)
    time = few.sample_time
    families = {"p": Linear(time, 1.0), "q": Linear(time, 0.6)}
    forward = SurrogateForward(families, {"x": (0.0, 1.0), "y": (0.0, 1.0)})
    conditions = tuple(Condition(name, "calibrate", few) for name in families)
    for _ in range(trials):
        data = {n: Observation(time, recordings(rng, f.predict(truth[None])[0])) for n, f in families.items()}
        fit = Fitter(Problem(conditions, data, forward, SCALE), 0.01, 0.0).base([np.array([0.5, 0.5])])
        found = intervals(fit)
        hits += (found.lower <= truth) & (truth <= found.upper)
    assert np.all(hits / trials > 0.91)
    assert np.all(hits / trials < 0.99)


def test_single_recordings_take_their_noise_from_the_misfit():
    found = calibrated(observed(np.random.default_rng(3), replicates=1, sigma=2.0, rho=0.0))
    assert found.noise["slow"]["sigma_nm"] == pytest.approx(2.0, rel=0.4)
    assert found.noise["slow"]["site_scatter"] == pytest.approx(QUICK.site_scatter)
    assert found.parameters["a"].lower < TRUTH["a"] < found.parameters["a"].upper


def test_error_measures_on_a_case_done_by_hand():
    measured, simulated = np.array([0.0, 100.0, 200.0]), np.array([0.0, 110.0, 190.0])
    table = error_measures(measured, simulated)
    assert table["rmse_nm"] == pytest.approx(np.sqrt(200 / 3))
    assert table["r2"] == pytest.approx(1 - 200 / 20000)
    assert table["mean_abs_error_nm"] == pytest.approx(20 / 3)
    assert table["percent_error"] == pytest.approx(7.5)
    assert mean_square(measured, simulated) == pytest.approx(200 / 3)
    assert relative(measured[1:], simulated[1:]) == pytest.approx(np.sqrt((0.1**2 + 0.05**2) / 2))


@pytest.mark.parametrize("role", ["calibrate", "validate"])
@pytest.mark.parametrize("depth", [0.0, 300.0, -300.0 * T], ids=["none", "constant", "negative"])
def test_a_depth_that_no_indentation_has_is_told(depth, role):
    data = observed(np.random.default_rng(3))
    data["fast"] = Observation(T, np.full((2, len(T)), depth), role)
    with pytest.raises(InputError, match="which is no indentation"):
        calibrated(data)


def test_recordings_are_resampled_on_the_sample_times():
    fine = np.linspace(0.0, 1.0, 501)
    seen = Observation.from_recordings(PROTOCOL, [Recording(fine, 2 * fine, 300 * fine)] * 2)
    assert seen.response == pytest.approx(np.tile(300 * T, (2, 1)), abs=0.01)
    with pytest.raises(InputError, match=r"ends at 0\.5 s"):
        Observation.from_recordings(PROTOCOL, [Recording(fine / 2, fine, fine, name="P_1")])


def test_few_points_of_a_sharp_tips_curve_tell_it_between_them():
    """Depth goes with the root of the load, and back with a power of it; straight lines err by 5 nm here."""
    few = np.linspace(0.0, 1.0, 41)[1:]

    def depth(time):
        load = PROTOCOL.drive_at(time)
        return np.where(time <= 0.5, 300 * np.sqrt(load), 200 + 100 * load**0.65)

    for sign in (1, -1):
        seen = Observation.from_recordings(PROTOCOL, [Recording(few, 2 * few, sign * depth(few))])
        assert seen.response[0] == pytest.approx(sign * depth(T), abs=1.0)
    assert np.abs(np.interp(T, few, depth(few)) - depth(T)).max() > 5.0


def test_what_cannot_be_calibrated_is_refused():
    data = observed(np.random.default_rng(0))
    with pytest.raises(InputError, match="no condition"):
        calibrated({})
    with pytest.raises(InputError, match="has no surrogate"):
        calibrated(data, Forward(), {"slow": Family()})
    with pytest.raises(InputError, match="every parameter is held"):
        calibrated(data, Forward(), bounds={"a": (1.0, 1.0), "b": (0.3, 0.3), "c": (0.0, 0.0), "d": (0.3, 0.3)})
    with pytest.raises(InputError, match="bounds of a"):
        calibrated(data, Forward(), bounds=BOUNDS | {"a": (2.0, 1.0)})
    with pytest.raises(InputError, match="measured at 20 points"):
        calibrated({"slow": Observation(T[:20], np.arange(40.0).reshape(2, 20))}, Forward())
    with pytest.raises(ValueError, match="objective"):
        CalibrationSettings(objective="absolute")
    with pytest.raises(InputError, match="not a number"):
        Observation(T, np.full(50, np.nan))
