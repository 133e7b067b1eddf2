"""What is called identified: a narrow interval that ends by itself, in a fit that explains the recordings."""

from types import SimpleNamespace

import numpy as np
import pytest

from palpate.diagnosis.diagnosis_result import material_parameters
from palpate.inference.estimates import Intervals, estimates
from palpate.materials import LAWS
from palpate.models.coordinates import Coordinates

HARDENING = {p.name: p for p in LAWS["bilinear_plasticity"].declared({})}


@pytest.mark.parametrize(("lower", "identified"), [(0.4, True), (0.0, False)])
def test_an_interval_that_ends_at_a_limit_of_the_law_identifies_nothing(lower, identified):
    """Hardening is never below zero: an interval that ends there does not tell how small it is."""
    coordinates = Coordinates.of({"hardening": (0.0, 1.0), "yield_stress": (0.1,)}, HARDENING)
    low, middle, high = (coordinates.scaled({"hardening": value}) for value in (lower, 0.5, 0.6))
    found = Intervals(low, high, np.eye(1))
    told = estimates(SimpleNamespace(coordinates=coordinates, z=middle), found, True)["hardening"]
    assert told.identified is identified
    assert told.lower == pytest.approx(lower, abs=1e-12)


@pytest.mark.parametrize(
    ("width", "explained", "identified"), [(0.3, True, True), (0.6, True, False), (0.3, False, False)]
)
def test_a_diagnosis_tells_by_the_same_rule_which_parameters_the_recordings_determine(width, explained, identified):
    coordinates = Coordinates.of({"hardening": (0.0, 1.0), "yield_stress": (0.1,)}, HARDENING)
    fit = SimpleNamespace(coordinates=coordinates, z=np.array([0.5]), problem=SimpleNamespace(material=1))
    draws = 0.5 + width / 0.95 * np.linspace(-0.5, 0.5, 1001)[:, None]
    told = material_parameters(fit, draws, explained)["hardening"]
    assert told["identified"] is identified
    assert told["lower"] < told["estimate"] < told["upper"]
