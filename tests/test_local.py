"""The forward model's curves around an optimum: what a design of runs tells of slopes and bends."""

import numpy as np
import pytest

from palpate.diagnosis.local import BENT, REACH, Local, design, two_level


@pytest.mark.parametrize("dimensions", [1, 5, 7, 8, 11])
def test_a_design_reaches_one_standard_deviation_along_every_axis(dimensions):
    rng = np.random.default_rng(3)
    root = rng.standard_normal((dimensions, dimensions))
    centre, covariance = rng.random(dimensions), root @ root.T
    places = two_level(centre, covariance)
    assert places.mean(axis=0) == pytest.approx(centre)
    assert (places - centre).T @ (places - centre) / len(places) == pytest.approx(covariance)
    assert len(places) <= 2 * dimensions


def test_the_ends_of_what_is_least_known_lie_in_the_design_unless_a_bound_is_near():
    centre, deviations = np.array([0.5, 0.5, 0.5, 0.5, 0.95]), np.array([0.01, 0.02, 0.1, 0.05, 0.2])
    places, axes = design(centre, np.diag(deviations**2))
    along = (places - centre) @ axes
    assert axes.shape == (5, BENT)
    assert np.abs(along).max(axis=0) == pytest.approx(REACH)
    assert np.all((places[8:] >= 0.0) & (places[8:] <= 1.0))
    assert len(places) == 8 + 2 * BENT - 1, "towards the near bound no run is worth it"


def runs(rng, deviations, points):
    """Return the centre and the places of a design, its axes, and curves that bend along these, and their terms."""
    at = rng.uniform(0.3, 0.7, len(deviations))
    places, axes = design(at, np.diag(deviations) ** 2)
    places = np.vstack([at, places])
    slope, bend = rng.standard_normal((points, len(at))), rng.standard_normal((points, BENT))
    along = (places - at) @ axes
    return at, places, axes, (places - at) @ slope.T + 0.5 * along**2 @ bend.T, slope, bend


def test_slopes_and_bends_are_found_however_unlike_the_coordinates_scales_are():
    rng = np.random.default_rng(4)
    _, places, axes, changes, slope, bend = runs(rng, np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5]), 30)
    curve = rng.standard_normal(30)
    local = Local.through(curve, places, curve + changes, axes)
    assert local.slope == pytest.approx(slope)
    assert local.bend == pytest.approx(bend)
    assert np.abs(local.scatter).max() < 1e-20
    assert local(places) == pytest.approx(curve + changes)


def test_the_slope_is_that_of_the_curves_within_the_ends_and_beyond():
    rng = np.random.default_rng(6)
    at, places, axes, changes, *_ = runs(rng, np.full(4, 0.1), 20)
    local = Local.through(np.zeros(20), places, changes, axes)
    for off in (0.05, 0.35):
        z = at + off * np.array([1.0, -1.0, 0.5, 0.2])
        steps = 1e-6 * np.eye(4)
        differences = (local(z + steps) - local(z - steps)).T / 2e-6
        assert local.slope_at(z) == pytest.approx(differences, abs=1e-6)


def test_moved_curves_keep_their_shape():
    rng = np.random.default_rng(7)
    _, places, axes, changes, *_ = runs(rng, np.full(4, 0.1), 20)
    local = Local.through(np.zeros(20), places, changes, axes)
    elsewhere, curve = places[3], rng.standard_normal(20)
    moved = local.moved(elsewhere, curve)
    assert moved(elsewhere[None])[0] == pytest.approx(curve)
    assert moved(places) - moved(places)[0] == pytest.approx(local(places) - local(places)[0])


def test_the_ripple_of_runs_goes_to_the_scatter_and_averages_out_of_the_slopes():
    rng = np.random.default_rng(5)
    at, ripple = np.full(7, 0.5), 0.01
    places, axes = design(at, 0.1**2 * np.eye(7))
    curves = ripple * rng.standard_normal((len(places) + 1, 4000))
    local = Local.through(np.zeros(4000), np.vstack([at, places]), curves, axes)
    assert np.sqrt(np.mean(np.diag(local.scatter))) == pytest.approx(ripple, rel=0.05)
    assert np.std(local.slope) < 1.05 * ripple / (0.1 * np.sqrt(8))
