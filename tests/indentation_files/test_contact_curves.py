"""Intervals of contact hold the truth as often as they say, on curves with every kind of baseline."""

import numpy as np
from contact_curves import SEEDS, draw, found_in, holds

CURVES = 40


def test_intervals_hold_the_contact():
    """Where 0.88 of all intervals hold the truth, fewer than 30 of 40 do in one sample of a hundred."""
    assert sum(holds(*found) for found in found_in(SEEDS["development"], CURVES)) >= 30


def test_curves_do_not_depend_on_what_is_found():
    first, again = (draw(np.random.default_rng(1)) for _ in range(2))
    assert first.kind == again.kind
    assert np.array_equal(first.load, again.load)
