"""The solver against curves that CalculiX computed beforehand, within the errors stated for them."""

from pathlib import Path

import numpy as np
import pytest

from palpate.fem.discretisation import RESOLUTIONS
from palpate.fem.indent import indent
from palpate.indenters import Indenter
from palpate.materials import LAWS
from palpate.protocol import Protocol
from palpate.specimen import Specimen

REFERENCE = Path(__file__).parent.parent.parent / "shared/reference"
pytestmark = pytest.mark.skipif(
    not REFERENCE.is_dir(), reason="the reference curves are not part of the repository (folder shared/reference)"
)
HOOKE = {"youngs_modulus": 3.28, "poisson_ratio": 0.34}
NORTON = HOOKE | {
    "steady_coefficient": 0.09,
    "steady_exponent": 0.20,
    "transient_coefficient": 0.0,
    "transient_exponent": 0.47,
    "retardation_time": 0.25,
}
BURGERS = NORTON | {"transient_coefficient": 0.24}
METAL = {"youngs_modulus": 70.0, "poisson_ratio": 0.345, "yield_stress": 0.1, "hardening": 0.5}


@pytest.mark.parametrize(
    ("name", "law", "values", "load", "duration", "stated"),
    [
        ("elastic", "elastic", HOOKE, 1.0, 1.0, 0.004),
        ("norton_creep", "nonlinear_burgers", NORTON, 1.0, 30.0, 0.004),
        ("burgers", "nonlinear_burgers", BURGERS, 1.0, 30.0, 0.004),
        ("bilinear_plasticity", "bilinear_plasticity", METAL, 4.9, 15.0, 0.01),
    ],
)
def test_agrees_with_calculix(name, law, values, load, duration, stated):
    """From 15 % of the load on; the plastic reference scatters by 1 % about its own scaling law, so its rms counts."""
    curve = np.loadtxt(REFERENCE / f"{name}.csv", delimiter=",", comments="#", skiprows=2)
    curve = curve[curve[:, 0] > 0]
    protocol = Protocol(np.array([0, duration, 2 * duration]), np.array([0, load, 0]), np.unique(curve[:, 0]))
    outcome = indent(Specimen(LAWS[law].coefficients(values)), Indenter("cone", 70.3), protocol, RESOLUTIONS["fine"])
    assert not outcome.reason
    deviation = (outcome.depth / curve[:, 2] - 1)[curve[:, 1] > 0.15 * load]
    measure = np.sqrt(np.mean(deviation**2)) if name == "bilinear_plasticity" else np.abs(deviation).max()
    assert measure < stated
