"""The linear Burgers solid under a shallow cone and under a sphere, loading and hold, against the closed forms."""

from __future__ import annotations

import numpy as np

from palpate.classical.viscoelastic_depth import Compliance, depth_while_growing
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Settings, Verification, depth, worst

VALUES = {
    "youngs_modulus": 3.28,
    "poisson_ratio": 0.499,
    "steady_coefficient": 0.09,
    "steady_exponent": 0.0,
    "transient_coefficient": 0.24,
    "transient_exponent": 0.0,
    "retardation_time": 5.0,
    "transient_coefficient_2": 0.10,
    "transient_exponent_2": 0.0,
    "retardation_time_2": 40.0,
}
SHEAR = VALUES["youngs_modulus"] / (2 * (1 + VALUES["poisson_ratio"]))
INCOMPRESSIBLE = Compliance.of(VALUES | {"youngs_modulus": 3 * SHEAR}, 0.5)
ALLOWED = 0.01  # of the depth: the solution is for incompressible bodies, and nu is 0.499


def run(settings: Settings) -> Outcome:
    """Compare both shapes over a ramp of 30 s and a hold of 30 s, from 10 % of the load on."""
    accuracy = "standard" if settings.quick else "fine"
    rows, plots = [], []
    for shape, load, indenter in (
        ("cone of 88 degrees", 1e-3, Indenter("cone", 88.0)),
        ("sphere of 100 um", 0.05, Indenter("sphere", 0.0, 1e5)),
    ):
        protocol = Protocol(np.array([0.0, 30.0, 60.0]), np.array([0.0, load, load]), np.linspace(0.6, 60.0, 100))
        found = depth(
            Specification("nonlinear_burgers", VALUES, indenter, protocol, accuracy=accuracy, kinematics="small")
        )
        time, expected = protocol.sample_time, depth_while_growing(INCOMPRESSIBLE, indenter, protocol)
        later = protocol.sample_load >= 0.1 * load
        quantity = f"depth under a {shape}, worst sample of ramp and hold, {accuracy} [nm]"
        rows.append(worst(quantity, expected[later], found[later], ALLOWED))
        plots.append(
            Plot(
                f"viscoelastic_{shape.split()[0]}",
                "time [s]",
                "depth [nm]",
                [
                    PlottedSeries("closed form", time, expected),
                    PlottedSeries(f"finite elements, {accuracy}", time[::4], found[::4], marks=True),
                ],
                [PlottedSeries(accuracy, time, 100 * (found / expected - 1))],
            )
        )
    note = "The closed forms are those of nu = 0.5; the simulations have nu = 0.499, which changes depth by 0.05 %."
    return Outcome(rows, plots, [note])


CASES = (Verification("viscoelastic", "Linear viscoelastic half-space: Lee and Radok", run),)
