"""The forward model's curves around an optimum: what a design of runs tells of slopes and bends."""

import itertools

import numpy as np
import pytest

from palpate.diagnosis.local import BENT, REACH, Local, Straight, design


def unbent(count):
    """No coordinate is a factor."""
    return Straight(np.full(count, np.inf))


@pytest.mark.parametrize("dimensions", [1, 2, 5, 11])
def test_differences_are_central_along_every_axis_and_both_ways_along_each_two_of_the_widest(dimensions):
    rng = np.random.default_rng(3)
    root = 0.05 * rng.standard_normal((dimensions, dimensions)) / dimensions
    centre, covariance = np.full(dimensions, 0.5), root @ root.T
    places, axes = design(centre, covariance, unbent(dimensions))
    steps, wide = places - centre, min(BENT, dimensions)
    assert len(places) == 2 * dimensions + wide * (wide - 1)
    assert steps.sum(axis=0) == pytest.approx(np.zeros(dimensions), abs=1e-12)
    known = dimensions - wide
    ends = steps[-2 * wide :] / REACH
    assert (steps[: 2 * known].T @ steps[: 2 * known] + ends.T @ ends) / 2 == pytest.approx(covariance)
    along = (steps[2 * known : -2 * wide] @ axes).round(9)
    assert sorted(map(tuple, np.abs(along))) == sorted(
        tuple(row) for pair in itertools.combinations(np.eye(wide), 2) for row in [sum(pair)] * 2
    )


def test_ends_stay_within_bounds_unless_these_are_nearer_than_a_deviation():
    centre, deviations = np.array([0.5, 0.5, 0.5, 0.5, 0.95]), np.array([0.01, 0.02, 0.1, 0.05, 0.02])
    places, axes = design(centre, np.diag(deviations**2), unbent(5))
    along = (places - centre) @ axes
    assert axes.shape == (5, BENT)
    assert np.abs(along).max(axis=0) == pytest.approx(REACH)
    deviations[4] = 0.03
    places, _ = design(centre, np.diag(deviations**2), unbent(5))
    assert places[:, 4].max() == pytest.approx(1.0)
    deviations[4] = 0.2
    places, _ = design(centre, np.diag(deviations**2), unbent(5))
    assert places[:, 4].max() == pytest.approx(1.15), "the caller's bounds hold there"


def runs(rng, deviations, points):
    """Return the centre and the places of a design, its axes, curves that bend and twist along these, their terms."""
    at = rng.uniform(0.3, 0.7, len(deviations))
    places, axes = design(at, np.diag(deviations) ** 2, unbent(len(at)))
    places = np.vstack([at, places])
    slope, bend = rng.standard_normal((points, len(at))), rng.standard_normal((points, 2 * BENT))
    a, b, c = along = ((places - at) @ axes).T
    return (
        at,
        places,
        axes,
        (places - at) @ slope.T + np.vstack([0.5 * along**2, a * b, a * c, b * c]).T @ bend.T,
        slope,
        bend,
    )


def test_slopes_and_bends_are_found_however_unlike_the_coordinates_scales_are():
    rng = np.random.default_rng(4)
    _, places, axes, changes, slope, bend = runs(rng, np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5]), 30)
    curve = rng.standard_normal(30)
    local = Local.through(curve, places, curve + changes, axes, unbent(5))
    assert local.slope == pytest.approx(slope)
    assert local.bend == pytest.approx(bend)
    assert np.abs(local.scatter).max() < 1e-20
    assert local(places) == pytest.approx(curve + changes)


def test_the_slope_is_that_of_the_curves_within_the_ends_and_beyond():
    rng = np.random.default_rng(6)
    at, places, axes, changes, *_ = runs(rng, np.full(4, 0.1), 20)
    local = Local.through(np.zeros(20), places, changes, axes, unbent(4))
    for off in (0.05, 0.35):
        z = at + off * np.array([1.0, -1.0, 0.5, 0.2])
        steps = 1e-6 * np.eye(4)
        differences = (local(z + steps) - local(z - steps)).T / 2e-6
        assert local.slope_at(z) == pytest.approx(differences, abs=1e-6)


def test_moved_curves_keep_their_shape():
    rng = np.random.default_rng(7)
    _, places, axes, changes, *_ = runs(rng, np.full(4, 0.1), 20)
    local = Local.through(np.zeros(20), places, changes, axes, unbent(4))
    elsewhere, curve = places[3], rng.standard_normal(20)
    moved = local.moved(elsewhere, curve)
    assert moved(elsewhere[None])[0] == pytest.approx(curve)
    assert moved(places) - moved(places)[0] == pytest.approx(local(places) - local(places)[0])


def test_what_runs_depart_from_their_fit_goes_to_the_scatter():
    rng = np.random.default_rng(5)
    at, departure = np.full(7, 0.5), 0.01
    places, axes = design(at, 0.1**2 * np.eye(7), unbent(7))
    curves = departure * rng.standard_normal((len(places) + 1, 4000))
    local = Local.through(np.zeros(4000), np.vstack([at, places]), curves, axes, unbent(7))
    assert np.sqrt(np.mean(np.diag(local.scatter))) == pytest.approx(departure, rel=0.05)


def test_what_acts_as_a_factor_counts_by_its_logarithm_and_none_of_it_by_itself():
    straight = Straight(np.array([0.01, np.inf]))
    z = np.array([[0.0, 0.3], [0.2, 0.4], [0.4, 0.5], [0.8, 0.6]])
    along = straight.of(z)
    assert straight.back(along) == pytest.approx(z)
    assert along[0] == pytest.approx([0.0, 0.3])
    assert np.diff(along[1:, 0]) == pytest.approx(0.01 * np.log(2.0), rel=0.05)
    assert straight.slope(z[0]) == pytest.approx([1.0, 1.0])
    step = 1e-6
    assert straight.slope(z) == pytest.approx((straight.of(z + step) - straight.of(z - step)) / (2 * step), rel=1e-6)


def test_a_valley_of_factors_is_straight():
    """The curve knows the ratio of two numbers alone, one of which counts by its logarithm already."""
    straight = Straight(np.array([1e-3, np.inf]))
    at = np.array([0.1, 0.5])

    def curves(z):
        return np.log(z[:, :1] * 10.0 ** (1.0 - 2.0 * z[:, 1:])) * np.linspace(1.0, 2.0, 9)

    places, axes = design(at, np.array([[2e-4, 1e-3], [1e-3, 6e-3]]), straight)
    places = np.vstack([at, places])
    local = Local.through(curves(at[None])[0], places, curves(places), axes, straight)
    far = np.array([[0.4, 0.5 + 0.5 * np.log10(4.0)]])
    assert local(far) == pytest.approx(curves(far), abs=0.05)


def test_what_no_run_moves_has_the_slope_that_is_known():
    rng = np.random.default_rng(8)
    at, moved = rng.uniform(0.3, 0.7, 5), np.array([True, True, False, True, True])
    places, axes = design(at, 0.01 * np.eye(5) + 0.003, unbent(5), moved)
    assert len(places) == 2 * 4 + BENT * (BENT - 1)
    assert np.all(places[:, 2] == at[2])
    places, slope = np.vstack([at, places]), rng.standard_normal((30, 5))
    curves = (places - at) @ slope.T
    local = Local.through(curves[0], places, curves, axes, unbent(5), np.where(moved, 0.0, slope))
    assert local.slope == pytest.approx(slope)
    assert np.abs(local.scatter).max() < 1e-20
    elsewhere = rng.random((3, 5))
    assert local(elsewhere) == pytest.approx((elsewhere - at) @ slope.T)
