"""What is called identified: a narrow interval that ends by itself, in a fit that explains the recordings."""

import numpy as np
import pytest

from palpate.inference.coordinates import Coordinates
from palpate.inference.estimates import estimates
from palpate.inference.intervals import Intervals
from palpate.inference.surrogate_space import Space
from palpate.materials import LAWS

HARDENING = {p.name: p for p in LAWS["bilinear_plasticity"].declared({})}


def told(coordinates, u, half):
    found = Intervals(np.array([half]), np.array([False]), np.array([True]), np.eye(1), 1.0)
    (free,) = [each for each in estimates(coordinates, np.array([u]), found, True).values() if not each.held]
    return free


@pytest.mark.parametrize(("u", "identified"), [(0.5, True), (0.05, False), (0.95, False)])
def test_an_interval_that_ends_at_its_range_identifies_nothing(u, identified):
    assert told(Space({"youngs_modulus": (1.0, 2.0)}), u, 0.1).identified is identified


@pytest.mark.parametrize(("estimate", "identified"), [(0.5, True), (0.001, False)])
def test_an_interval_that_ends_at_a_limit_of_the_law_identifies_nothing(estimate, identified):
    """Hardening is never below zero: an interval that is cut off there does not tell how small it is."""
    coordinates = Coordinates.of({"hardening": (0.0, 1.0), "yield_stress": (0.1,)}, HARDENING)
    u = float(coordinates.free[0].scaled(estimate))
    found = told(coordinates, u, 0.2)
    assert found.identified is identified
    assert (found.lower < 1e-12) is not identified
