"""The forward model's curves around an optimum: what a design of runs tells of slopes and bends."""

import itertools

import numpy as np
import pytest

from palpate.diagnosis.local import BENT, REACH, Local, Straight, design


def unbent(count):
    """No coordinate is a factor."""
    return Straight(np.full(count, np.inf))


@pytest.mark.parametrize("dimensions", [1, 5, 7, 8, 11])
def test_a_design_reaches_one_standard_deviation_along_every_axis(dimensions):
    rng = np.random.default_rng(3)
    root = rng.standard_normal((dimensions, dimensions))
    centre, covariance = rng.random(dimensions), root @ root.T
    places, axes = design(centre, covariance, unbent(dimensions))
    runs = 8 if dimensions < 5 else 16
    two_level, ends = places[:runs] - centre, places[runs:]
    assert two_level.mean(axis=0) == pytest.approx(np.zeros(dimensions), abs=1e-12)
    assert two_level.T @ two_level / runs == pytest.approx(covariance)
    assert len(ends) <= 2 * axes.shape[1]


def test_no_slope_is_mistaken_for_a_twist_between_the_widest_axes():
    centre = np.full(9, 0.5)
    places, axes = design(centre, np.diag(np.linspace(0.01, 0.05, 9) ** 2), unbent(9))
    along = ((places[:16] - centre) @ axes).round(9)
    for first, second in itertools.combinations(range(BENT), 2):
        assert (places[:16] - centre).T @ (along[:, first] * along[:, second]) == pytest.approx(np.zeros(9), abs=1e-12)


def test_the_ends_of_what_is_least_known_lie_in_the_design_unless_a_bound_is_near():
    centre, deviations = np.array([0.5, 0.5, 0.5, 0.5, 0.95]), np.array([0.01, 0.02, 0.1, 0.05, 0.2])
    places, axes = design(centre, np.diag(deviations**2), unbent(5))
    along = (places - centre) @ axes
    assert axes.shape == (5, BENT)
    assert np.abs(along).max(axis=0) == pytest.approx(REACH)
    assert np.all((places[16:] >= 0.0) & (places[16:] <= 1.0))
    assert len(places) == 16 + 2 * BENT - 1, "towards the near bound no run is worth it"


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


def test_the_ripple_of_runs_goes_to_the_scatter_and_averages_out_of_the_slopes():
    rng = np.random.default_rng(5)
    at, ripple = np.full(7, 0.5), 0.01
    places, axes = design(at, 0.1**2 * np.eye(7), unbent(7))
    curves = ripple * rng.standard_normal((len(places) + 1, 4000))
    local = Local.through(np.zeros(4000), np.vstack([at, places]), curves, axes, unbent(7))
    assert np.sqrt(np.mean(np.diag(local.scatter))) == pytest.approx(ripple, rel=0.05)
    assert np.std(local.slope) < 1.05 * ripple / (0.1 * np.sqrt(16))


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
    assert len(places) == 8 + 2 * BENT, "one coordinate less takes half the runs"
    assert np.all(places[:, 2] == at[2])
    places, slope = np.vstack([at, places]), rng.standard_normal((30, 5))
    curves = (places - at) @ slope.T
    local = Local.through(curves[0], places, curves, axes, unbent(5), np.where(moved, 0.0, slope))
    assert local.slope == pytest.approx(slope)
    assert np.abs(local.scatter).max() < 1e-20
    elsewhere = rng.random((3, 5))
    assert local(elsewhere) == pytest.approx((elsewhere - at) @ slope.T)
