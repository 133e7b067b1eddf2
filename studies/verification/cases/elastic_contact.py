"""Sneddon's cone where it is shallow enough for his solution to be exact, and Hertz' sphere."""

from __future__ import annotations

import numpy as np

from palpate.analytic import hertz, sneddon
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth, worst
from studies.verification.reference_materials import HOOKE

SHALLOW = 89.0  # degrees: the solution neglects what the slope of a steeper cone does
RADIUS = 1e5  # nm
WITHIN = {"standard": 0.01, "fine": 0.005}  # of the depth, by accuracy


def _loading(load: float, points: int) -> Protocol:
    return Protocol(np.array([0.0, 1.0]), np.array([0.0, load]), np.arange(1, points + 1) / points)


def run_sneddon(settings: Settings) -> Outcome:
    """Compare the depth under a shallow cone, and show how the small-slope solution departs for sharper ones."""
    angles = np.array([70.3, 80.0, SHALLOW]) if settings.quick else np.array([65.0, 70.3, 75.0, 80.0, 85.0, SHALLOW])
    protocol, rows, ratios = _loading(1e-3, 10), [], []
    for accuracy, allowed in WITHIN.items():
        found = depth(
            Specification("elastic", HOOKE, Indenter("cone", SHALLOW), protocol, accuracy=accuracy, kinematics="small")
        )
        exact = sneddon.depth(protocol.sample_load, **HOOKE, half_angle=SHALLOW)
        quantity = f"depth under a cone of {SHALLOW:g} degrees, worst sample from 10 % of the load on, {accuracy} [nm]"
        rows.append(worst(quantity, exact, found, allowed))
    for angle in angles:
        found = depth(
            Specification(
                "elastic", HOOKE, Indenter("cone", float(angle)), protocol, accuracy="fine", kinematics="small"
            )
        )
        ratios.append(float(np.mean(found / sneddon.depth(protocol.sample_load, **HOOKE, half_angle=float(angle)))))
    sharp = sneddon.depth(1e-3, **HOOKE, half_angle=70.3)
    k = int(np.argmin(np.abs(angles - 70.3)))
    note = "not a check: Sneddon neglects the slope and the radial displacement of the surface"
    rows.append(Row("depth under a cone of 70.3 degrees [nm]", float(sharp), float(ratios[k] * sharp), None, note))
    plot = Plot(
        "sneddon",
        "half-angle of the cone [deg]",
        "depth / Sneddon's depth, mean of ten loads",
        [
            PlottedSeries("finite elements, fine", angles, ratios, marks=True),
            PlottedSeries("Sneddon (shallow limit)", [float(angles[0]), 90.0], [1.0, 1.0]),
        ],
    )
    return Outcome(rows, [plot])


def run_hertz(settings: Settings) -> Outcome:
    """Compare the loading curve of a sphere whose contact stays below 2 % of its radius."""
    protocol = _loading(0.5, 20)
    exact = hertz.depth(protocol.sample_load, **HOOKE, radius=RADIUS)
    rows, deviations = [], []
    for accuracy, allowed in WITHIN.items():
        found = depth(
            Specification(
                "elastic", HOOKE, Indenter("sphere", 0.0, RADIUS), protocol, accuracy=accuracy, kinematics="small"
            )
        )
        later = protocol.sample_load >= 0.1 * protocol.max_load
        quantity = f"depth under a sphere, worst sample from 10 % of the load on, {accuracy} [nm]"
        rows.append(worst(quantity, exact[later], found[later], allowed))
        deviations.append(PlottedSeries(accuracy, protocol.sample_load, 100 * (found / exact - 1)))
    load = protocol.sample_load
    plot = Plot(
        "hertz",
        "load [mN]",
        "depth [nm]",
        [
            PlottedSeries("Hertz", load, exact),
            PlottedSeries("finite elements, fine", load, found, marks=True),
        ],
        deviations,
    )
    return Outcome(rows, [plot])


CASES = (
    Verification("sneddon", "Elastic half-space under a cone: Sneddon", run_sneddon),
    Verification("hertz", "Elastic half-space under a sphere: Hertz", run_hertz),
)
