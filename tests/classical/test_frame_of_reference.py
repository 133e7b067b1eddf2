"""The frame from a solid of known modulus: exact on unloadings made by the equations, as uncertain as what is known."""

import numpy as np
import pytest
from scipy.optimize import brentq

from palpate.classical.oliver_pharr import BETA, EPSILON
from palpate.classical.reference_sample import ReferenceSample, frame_of_reference
from palpate.study.area_function import AreaFunction

AREA = AreaFunction((24.5, 300.0))
HARDNESS, MODULUS = 9.0, 69.6


def recording(frame, peak=100.0, hardness=HARDNESS, exponent=1.3):
    """Loading by a power law, unloading by the equations of Oliver and Pharr, on a frame."""
    contact_depth = brentq(lambda h: 1e-6 * hardness * float(AREA.area(np.array(h))) - peak, 1.0, 1e4)
    root = np.sqrt(float(AREA.area(np.array(contact_depth))))
    compliance = 1e6 * np.sqrt(np.pi) / (2 * BETA * MODULUS * root)
    deepest = contact_depth + EPSILON * peak * compliance
    up, down = np.linspace(0.01, 1.0, 200), np.linspace(1.0, 0.1, 300)[1:]
    elastic = exponent * peak * compliance
    depth = np.concatenate([deepest * np.sqrt(up), deepest - elastic * (1.0 - down ** (1.0 / exponent))])
    load = peak * np.concatenate([up, down])
    return load, depth + frame * load


@pytest.mark.parametrize("frame", [0.0, 0.2, 1.5])
@pytest.mark.parametrize("exponent", [1.2, 1.5])
def test_the_frame_that_was_put_in_comes_out(frame, exponent):
    reference = ReferenceSample(MODULUS, AREA, 0.01)
    found = frame_of_reference([recording(frame, exponent=exponent)], reference)
    assert found.compliance == pytest.approx(frame, abs=0.01)


@pytest.mark.parametrize("error", [-0.02, 0.02])
def test_the_interval_holds_what_a_wrong_modulus_does(error):
    found = frame_of_reference([recording(0.2)] * 3, ReferenceSample(MODULUS * (1 + error), AREA, 0.02))
    assert found.lower < 0.2 < found.upper
    assert abs(found.compliance - 0.2) > 0.03, "2 % of the contact are much of the frame"


def test_sites_that_scatter_widen_the_interval():
    rng, reference = np.random.default_rng(3), ReferenceSample(MODULUS, AREA, 1e-4)
    tests = [recording(0.2 + 0.05 * rng.standard_normal()) for _ in range(8)]
    found = frame_of_reference(tests, reference)
    assert found.lower < 0.2 < found.upper
    assert 0.02 < found.upper - found.lower < 0.2
