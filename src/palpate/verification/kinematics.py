"""Small against large strains: how much the choice matters, and what CalculiX found for the same tests."""

from __future__ import annotations

import numpy as np

from palpate.protocol import trapezoid
from palpate.specification import Specification
from palpate.verification.case import Case, Outcome, Plot, Row, Series, Settings, depth
from palpate.verification.materials import ALUMINIUM, BURGERS, CONE

CALCULIX = {
    "epoxy": {"small": (499.3, 440.3), "large": (491.7, 429.2)},
    "aluminium": {"small": (675.1, 658.0), "large": (617.0, 600.0)},
}
STATED = {"epoxy": 0.004, "aluminium": 0.01}
NOTES = {
    "end": "not a check: CalculiX loses contact before the end",
    "small": "expected: CalculiX 2.20 with the same law; allowed: its stated error",
    "large": "not a check: CalculiX measures large strains in another way",
}


def run(settings: Settings) -> Outcome:
    """Tabulate the depth at peak and at the end for both kinematics; the small-strain peaks are checked."""
    tests = {"epoxy": ("nonlinear_burgers", BURGERS, trapezoid(1.0, 30.0, 0.0, 30.0))}
    if not settings.quick:
        tests["aluminium"] = ("bilinear_plasticity", ALUMINIUM, trapezoid(4.9, 15.0, 0.0, 15.0))
    rows, plots, notes = [], [], []
    for name, (law, values, protocol) in tests.items():
        curves, peak = {}, int(np.argmax(protocol.sample_load))
        for kinematics, expected in CALCULIX[name].items():
            curve = depth(Specification(law, values, CONE, protocol, kinematics=kinematics, accuracy="fine"))
            curves[kinematics] = curve
            for where, value, index in zip(("peak", "end"), expected, (peak, -1), strict=True):
                checked = kinematics == "small" and where == "peak"
                quantity = f"{name}: depth at {where}, {kinematics} strain [nm]"
                note = (
                    NOTES[kinematics]
                    if checked or kinematics == "large"
                    else "not a check: the reference loses contact before"
                )
                rows.append(Row(quantity, value, float(curve[index]), STATED[name] if checked else None, note))
        notes.append(_sentence(name, curves["small"][peak], curves["large"][peak]))
        load = protocol.sample_load.tolist()
        series = [Series(f"{kinematics} strain", curve.tolist(), load) for kinematics, curve in curves.items()]
        plots.append(Plot(f"kinematics_{name}", f"depth of the {name} [nm]", "load [mN]", series))
    return Outcome(rows, plots, notes)


def _sentence(name: str, small: float, large: float) -> str:
    if np.isnan(large):
        return f"{name}: the simulation at large strains did not reach the peak."
    return f"{name}: large strains change the depth at peak by {100 * (large / small - 1):.2f} %."


CASE = Case("kinematics", "Small against large strains", run)
