"""A retardation spectrum, alone and beside Burgers creep: against integration, its power law, and under a cone."""

import numpy as np
import pytest
from homogeneous import BURGERS_TERMS, HOOKE, error, integrated, updated
from under_a_cone import check_law

from palpate.materials import LAWS
from palpate.materials.flow.row import NUMBERS, TIME, blocks_of

FLOW = {"spectrum_coefficient": 0.05, "spectrum_exponent": 0.2, "shortest_time": 0.1, "longest_time": 100.0}


@pytest.mark.parametrize("joined", [False, True])
def test_a_turning_strain_gives_the_stress_of_the_rate_equations(joined):
    values, model = HOOKE | FLOW | {"elements": 7}, "retardation_spectrum"
    elements = [(t, lambda q, t=t: 0.05 * t**0.2) for t in np.geomspace(0.1, 100.0, 7)]
    creep = BURGERS_TERMS["terms"] if joined else {"creep": lambda q, p, alpha: 0.0, "elements": ()}
    if joined:
        values, model = values | BURGERS_TERMS["values"], "nonlinear_burgers+retardation_spectrum"
    expected = integrated(HOOKE, 0.05, creep=creep["creep"], elements=[*elements, *creep["elements"]])
    coarse, fine = (error(updated(model, values, steps, 0.05), expected) for steps in (50, 100))
    assert fine < 1e-4 and fine < 0.3 * coarse


def test_the_compliance_grows_as_a_power_of_time():
    row = LAWS["retardation_spectrum"].coefficients(HOOKE | FLOW | {"longest_time": 1e5, "elements": 25})
    elements = [(row[term.at + TIME], row[term.at + NUMBERS]) for term in blocks_of(row)]
    times = np.geomspace(30.0, 300.0, 20)
    compliance = sum(j * -np.expm1(-times / t) for t, j in elements)
    slope = np.polyfit(np.log(times), np.log(compliance + 1.0), 1)[0]
    exact = np.gradient(np.log(compliance), np.log(times))
    assert 0.0 < slope < exact.max()
    assert exact == pytest.approx(0.2, abs=0.08)


def test_under_a_cone():
    flow = {"spectrum_coefficient": 0.05, "spectrum_exponent": 0.1}
    slow = flow | {"shortest_time": 1.0, "longest_time": 1e4, "spectrum_coefficient": 0.05 * 10.0**-0.1}
    check_law("retardation_spectrum", flow, {"spectrum_coefficient": 0.08}, slow)
