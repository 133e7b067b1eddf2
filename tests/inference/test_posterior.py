"""Intervals of a diagnosis: draws that follow the likelihood, from curves that bend; fits that noise does not draw."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from closed_forms import ClosedForms
from diagnosis_problem import CONDITIONS, SCALE, fitted, problem, recordings

from palpate.inference.covariance import errors, noise_of
from palpate.inference.explanation import Fit
from palpate.inference.posterior import AXES, REACH, Curvature, posterior_draws
from palpate.inference.problem import Problem
from palpate.models.coordinates import Coordinate, Coordinates

TRUTH = np.array([(1.0 - 0.7) / 0.7, 0.01 / 0.03])


def test_draws_agree_with_the_first_order_covariance_where_the_likelihood_is_even():
    fit = fitted(problem(recordings(np.random.default_rng(5))))
    draws = posterior_draws(fit)
    assert draws.mean(axis=0) == pytest.approx(fit.z, abs=0.4 * np.sqrt(np.diag(fit.posterior)).max())
    assert draws.std(axis=0) == pytest.approx(np.sqrt(np.diag(fit.posterior)), rel=0.3)


def test_the_noise_of_the_recordings_does_not_draw_the_fit_to_smaller_depths():
    """The bias of errors in proportion to recorded depths: D'Agostini, Nucl. Instrum. Methods A 346 (1994) 306."""
    rng, bias = np.random.default_rng(8), []
    for _ in range(16):
        fit = fitted(problem(recordings(rng, sigma=3.0, memory=0.2, site=0.03)))
        bias.append((fit.z - TRUTH) / np.sqrt(np.diag(fit.posterior)))
    assert np.all(np.abs(np.mean(bias, axis=0)) < 2.6 / np.sqrt(16))


class Quadratic(ClosedForms):
    """Depths in proportion to the time, and of second order in the coordinates."""

    def _curve(self, u, condition):
        rng = np.random.default_rng(CONDITIONS.index(condition))
        slope, bend = rng.standard_normal(len(u)), rng.standard_normal((len(u), len(u)))
        depth = (20.0 + slope @ u + 0.5 * u @ (bend + bend.T) @ u) * condition.protocol.sample_time
        return depth[self.keep[condition.name]] if self.keep else depth


def known_to(deviations, at, least=-np.inf):
    """Return a fit of quadratic curves whose parameters are known to these standard deviations, nearly."""
    free = [Coordinate(f"p{number}", 0.0, 1.0, least, np.inf) for number in range(len(at))]
    observed = recordings(np.random.default_rng(1))
    problem = Problem(CONDITIONS, observed, Quadratic(CONDITIONS, Coordinates(free, {})), SCALE)
    ((curves, slopes),) = problem.forward.tangents([at])
    curve, tangent = problem.stacked(curves), problem.stacked(slopes)
    found = errors(problem, problem.forward, (), curve, noise_of(problem, (), problem.mean, 0.01), 0.003)
    fit = Fit(problem, (), problem.forward, at, found, curve, tangent)
    fit.__dict__["posterior"] = np.diag(np.square(deviations))
    return fit


def simulated(fit, z):
    return np.array([fit.problem.stacked(curves) for curves in fit.model.curves(z)])


def bent(curvature, z):
    return curvature.features(z) @ curvature.columns.T


def test_slopes_and_bends_are_found_however_unlike_the_coordinates_scales_are():
    """Exactly so for curves of second order, but for how they bend along the axes on which most is known."""
    deviations = np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
    fit = known_to(deviations, np.random.default_rng(4).uniform(0.3, 0.7, 5))
    curvature = Curvature.of(fit)
    along, off = np.random.default_rng(5).uniform(-REACH, REACH, (2, 20, 5)) * deviations
    along[:, AXES:], off[:, :AXES] = 0.0, 0.0
    expected = simulated(fit, fit.z + along + off) - simulated(fit, fit.z + off)
    straight = fit.curve + off @ fit.tangent.T
    bend = np.abs(expected - along @ fit.tangent.T).max()
    assert bent(curvature, fit.z + along + off) == pytest.approx(expected + straight, abs=1e-4 * bend)


def test_axes_lie_along_what_is_least_known_whatever_the_coordinates():
    fit = known_to(np.full(4, 0.1), np.full(4, 0.5))
    turned = np.linalg.qr(np.random.default_rng(2).standard_normal((4, 4)))[0]
    spread = np.array([0.1, 0.05, 0.02, 0.0])
    fit.__dict__["posterior"] = (turned * spread**2) @ turned.T
    z = fit.z + (np.random.default_rng(3).uniform(-REACH, REACH, (20, 4)) * spread) @ turned.T
    assert bent(Curvature.of(fit), z) == pytest.approx(simulated(fit, z), abs=1e-3)


def test_curves_go_on_straight_beyond_two_deviations():
    fit = known_to(np.full(2, 0.1), np.full(2, 0.5))
    places = fit.z + 0.1 * np.outer([REACH, REACH + 1.0, REACH + 2.0, REACH + 4.0], [1.0, 0.0])
    curves = bent(Curvature.of(fit), places)
    assert curves[0] == pytest.approx(simulated(fit, places[:1])[0], abs=1e-3)
    assert curves[2] - curves[1] == pytest.approx(curves[1] - curves[0], abs=1e-3)
    assert curves[3] - curves[2] == pytest.approx(2.0 * (curves[1] - curves[0]), abs=1e-3)
    step = 1e-6
    ahead = bent(Curvature.of(fit), places[:1] + step * np.array([1.0, 0.0])) - curves[:1]
    assert ahead[0] / step == pytest.approx((curves[1] - curves[0]) / 0.1, rel=1e-3, abs=1e-2)


@pytest.mark.parametrize("room", [0.0, 0.03, 0.2])
def test_curves_bend_as_much_beside_a_limit(room):
    """Where one end would lie beyond it."""
    fit = known_to(np.full(2, 0.1), np.array([room, 0.5]), least=0.0)
    places = fit.z + 0.1 * np.array([[0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [1.5, -1.0]])
    assert bent(Curvature.of(fit), places) == pytest.approx(simulated(fit, places), abs=1e-3)


class Fragile(Quadratic):
    """Fails where the first coordinate is large."""

    def tangents(self, points):
        return [
            "no equilibrium" if u[0] > 0.55 else found
            for u, found in zip(points, super().tangents(points), strict=True)
        ]


def test_where_one_end_fails_the_other_tells_how_curves_bend():
    fit = known_to(np.full(2, 0.1), np.full(2, 0.5))
    fit = replace(fit, model=Fragile(CONDITIONS, fit.coordinates))
    fit.__dict__["posterior"] = 0.01 * np.eye(2)
    places = fit.z + 0.1 * np.array([[-1.0, 0.0], [0.0, 2.0], [2.0, 0.0], [1.0, -1.0]])
    assert bent(Curvature.of(fit), places) == pytest.approx(simulated(fit, places), abs=1e-3)


def exact_slopes(fit):
    """Return the slopes of the forward model at a fit."""
    ((_, slopes),) = fit.model.tangents([fit.z])
    return fit.problem.stacked(slopes)


def test_a_taylor_series_follows_curves_that_bend():
    """Those of a cone of which little is known; samples between those that are simulated lie on lines."""
    fit = fitted(problem(recordings(np.random.default_rng(5), sigma=100.0, site=0.05)))
    fit = replace(fit, tangent=exact_slopes(fit))
    assert np.sqrt(fit.posterior[0, 0]) > 0.1
    curvature = Curvature.of(fit)
    for deviations, share in ((0.5, 0.05), (1.0, 0.1), (2.0, 0.2)):
        steps = np.random.default_rng(1).uniform(-deviations, deviations, (200, 2)) @ curvature.axes.T
        exact, straight = simulated(fit, fit.z + steps), fit.curve + steps @ fit.tangent.T
        off = [np.sqrt(np.mean((curves - exact) ** 2)) for curves in (bent(curvature, fit.z + steps), straight)]
        assert off[0] < share * off[1]


@pytest.mark.parametrize("explanation", [(), ("thermal_drift",), ("frame_compliance", "thermal_drift")])
def test_what_a_fit_leaves_open_rests_on_the_forward_models_slopes(explanation):
    drifting = recordings(np.random.default_rng(1), lambda c, r: 0.1 * c.protocol.sample_time)
    fit = fitted(problem(drifting), explanation)
    known = np.sqrt(np.diag(fit.posterior))
    assert known == pytest.approx(np.sqrt(np.diag(replace(fit, tangent=exact_slopes(fit)).posterior)), rel=0.05)


@dataclass(frozen=True, eq=False)
class Faded(ClosedForms):
    """The slope by the second coordinate fades beyond a place, by e over some length."""

    place: float = 0.0
    over: float = 1.0

    def _curve(self, u, condition):
        faded = self.place + self.over * (1.0 - np.exp((self.place - u[1]) / self.over))
        return super()._curve(np.array([u[0], faded]), condition)


def test_a_bent_valley_is_followed_and_its_length_seen():
    """Where the slope fades, by e over four standard deviations, the interval reaches further on that side."""
    task = problem(recordings(np.random.default_rng(2)))
    rough = fitted(task)
    over = 4.0 * np.sqrt(rough.posterior[1, 1])
    found = fitted(replace(task, forward=Faded(CONDITIONS, place=rough.z[1], over=over)), start=rough.z)
    draws = posterior_draws(found)[:, 1]
    low, middle, high = np.percentile(draws, [2.5, 50.0, 97.5])
    assert high - middle > 1.1 * (middle - low)
    assert middle - low < 0.5 * over
