"""The forward model's curves around an optimum: what a design of runs tells of slopes."""

import numpy as np
import pytest

from palpate.diagnosis.local import Local, two_level


@pytest.mark.parametrize("dimensions", [1, 5, 7, 8, 11])
def test_a_design_reaches_one_standard_deviation_along_every_axis(dimensions):
    rng = np.random.default_rng(3)
    root = rng.standard_normal((dimensions, dimensions))
    centre, covariance = rng.random(dimensions), root @ root.T
    places = two_level(centre, covariance)
    assert places.mean(axis=0) == pytest.approx(centre)
    assert (places - centre).T @ (places - centre) / len(places) == pytest.approx(covariance)
    assert len(places) <= 2 * dimensions


def test_a_plane_is_found_however_unlike_the_coordinates_scales_are():
    rng = np.random.default_rng(4)
    slope, curve, at = rng.standard_normal((30, 5)), rng.standard_normal(30), rng.random(5)
    places = np.vstack([at, two_level(at, np.diag([1e-1, 1e-2, 1e-3, 1e-4, 1e-5]) ** 2)])
    plane = Local.through(at, curve, places, curve + (places - at) @ slope.T)
    assert plane.slope == pytest.approx(slope)
    assert np.abs(plane.scatter).max() < 1e-20
    elsewhere = plane.moved(at + 0.1, np.zeros(30))
    assert elsewhere((at + 0.1)[None])[0] == pytest.approx(np.zeros(30))
    assert elsewhere(at[None])[0] == pytest.approx(-0.1 * slope.sum(axis=1))


def test_the_ripple_of_runs_goes_to_the_scatter_and_averages_out_of_the_slopes():
    rng = np.random.default_rng(5)
    at, ripple = np.full(7, 0.5), 0.01
    places = np.vstack([at, two_level(at, 0.1**2 * np.eye(7))])
    curves = ripple * rng.standard_normal((len(places), 4000))
    plane = Local.through(at, np.zeros(4000), places, curves)
    assert np.sqrt(np.mean(np.diag(plane.scatter))) == pytest.approx(ripple, rel=0.05)
    assert np.std(plane.slope) == pytest.approx(ripple / (0.1 * np.sqrt(8)), rel=0.05)
