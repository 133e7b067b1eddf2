"""The rule that judges an instrument's mark of contact, on curves whose contact is known."""

import numpy as np
import pytest
from contact_curves import RARE, draw
from contact_marks import judged

SHIFTED = 0.3  # of the depth, a mark that is wrong beyond doubt


def _marked(curve, mark):
    """Time of a curve, zero where it first comes to a depth, with its load and depth."""
    reached = int(np.argmax(curve.depth >= mark))
    return curve.time - curve.time[reached], curve.load, curve.depth


def _plain(count):
    """Curves with a straight baseline and an approach as long as the test at least."""
    rng, found = np.random.default_rng(77), []
    while len(found) < count:
        curve = draw(rng)
        words = curve.kind.split()
        if not {"wave", "transient", "tilt", "drift", *RARE} & {*words} and words[words.index("memory") + 1] == "0":
            found.append(curve)
    return found


def test_a_right_mark_is_confirmed_and_a_mark_in_air_is_not():
    curves = _plain(40)
    right = [judged(*_marked(curve, curve.contact)) for curve in curves]
    early = [judged(*_marked(curve, curve.contact - SHIFTED * curve.reach)) for curve in curves]
    told = [verdict for verdict in early if not verdict.startswith("not judged")]
    assert sum(verdict.startswith("contradicted") for verdict in right) <= 2
    assert len(told) > 20
    assert np.mean([verdict.startswith("contradicted") for verdict in told]) >= 0.7


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
def test_a_mark_within_the_body_is_contradicted(power):
    time = np.linspace(-10, 10, 2001)
    load = np.clip(time, 0, None) ** power + np.random.default_rng(0).normal(0, 1e-3, len(time))
    assert judged(time, load, 10 * time) == "confirmed"
    assert judged(time - 2, load, 10 * time).startswith("contradicted: the load has left")
    assert judged(time + 5, load, 10 * time).startswith("contradicted")
