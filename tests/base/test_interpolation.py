"""Curves between few of their points."""

import numpy as np
import pytest

from palpate.base.interpolation import depth_at, smooth_between

TIME = np.linspace(0.1, 10.0, 100)
CORNER = TIME[49]


def with_kink(time):
    """Return a curve that is smooth but at the corner, and another one beside it."""
    curve = np.exp(-0.3 * time) + np.where(time > CORNER, 0.4 * (time - CORNER), 0.0)
    return np.stack([curve, 2.0 - curve], axis=1)


def test_a_curve_is_smooth_between_corners_and_keeps_its_kink_there():
    """Fritsch and Butland's cubics err by less than a fifth of what straight lines do."""
    knots = np.unique(TIME[np.r_[0:100:6, 49, 99]])
    found = smooth_between(np.array([0.0, CORNER, 10.0]), TIME, knots, with_kink(knots))
    straight = np.stack([np.interp(TIME, knots, column) for column in with_kink(knots).T], axis=1)
    true = with_kink(TIME)
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.2 * np.sqrt(np.mean((straight - true) ** 2))
    assert found[49] == pytest.approx(true[49])


def test_where_corners_lie_close_together_lines_are_straight():
    """As in a history that was recorded, whose corners are its samples."""
    knots = np.array([0.1, 2.0, 5.0, 10.0])
    values = np.array([[1.0], [3.0], [2.0], [2.5]])
    found = smooth_between(knots, TIME, knots, values)
    assert found[:, 0] == pytest.approx(np.interp(TIME, knots, values[:, 0]))


def test_a_point_at_the_start_does_not_bend_the_curve():
    """Clocks that were brought to the same start leave points within rounding of it."""
    time = np.append(1e-11, np.linspace(0.0, 10.0, 31)[1:])
    moments = np.array([0.05, 0.2, 0.3])
    found = depth_at(moments, time, 300.0 * np.sqrt(time), np.array([0.0, 10.0]), np.array([0.0, 2.0]))
    assert found == pytest.approx(300.0 * np.sqrt(moments), rel=2e-3)
