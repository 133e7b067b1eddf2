"""Reference curves that CalculiX computed beforehand, kept in a folder of recordings with stated refinement errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from indentation_files.recording_file import read_recording
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Settings, Verification, depth, rms, worst
from studies.verification.reference_materials import ALUMINIUM, BURGERS, CONE, HOOKE, STEADY_CREEP


@dataclass(frozen=True)
class ReferenceCurve:
    """A curve's file name, the test that it belongs to, and its refinement error, relative.

    That of the plastic curve is the largest difference of its depths at peak on three meshes: 672.9 to 680.9 nm.
    """

    name: str
    law: str
    values: dict[str, float]
    load: float
    duration: float
    refinement: float


REFERENCES = (
    ReferenceCurve("elastic", "elastic", HOOKE, 1.0, 1.0, 0.004),
    ReferenceCurve("norton_creep", "nonlinear_burgers", STEADY_CREEP, 1.0, 30.0, 0.004),
    ReferenceCurve("burgers", "nonlinear_burgers", BURGERS, 1.0, 30.0, 0.004),
    ReferenceCurve("bilinear_plasticity", "bilinear_plasticity", ALUMINIUM, 4.9, 15.0, 0.012),
)


def run(settings: Settings) -> Outcome:
    """Compare with every curve that the folder holds, from 15 % of the load on."""
    if settings.reference is None:
        return Outcome([], notes=["No folder of reference curves was given."])
    rows, plots = [], []
    for reference in REFERENCES:
        file = settings.reference / f"{reference.name}.csv"
        if not file.is_file():
            continue
        curve = read_recording(file)
        kept = curve.time > 0
        time, expected = curve.time[kept], curve.depth[kept]
        knots = reference.duration * np.array([0.0, 1.0, 2.0])
        protocol = Protocol(knots, reference.load * np.array([0.0, 1.0, 0.0]), time)
        found = depth(
            Specification(reference.law, reference.values, CONE, protocol, accuracy="fine", kinematics="small")
        )
        counts = curve.load[kept] >= 0.15 * reference.load
        quantity, note = f"{reference.name}: depth, worst sample [nm]", "allowed: the curve's own refinement error"
        rows.append(worst(quantity, expected[counts], found[counts], reference.refinement, note))
        rows.append(rms(f"{reference.name}: depth, root mean square [nm]", expected[counts], found[counts]))
        series = [
            PlottedSeries("reference", time, expected, True),
            PlottedSeries("fine", time, found),
        ]
        deviation = 100 * (found[counts] / expected[counts] - 1)
        lower = [PlottedSeries("deviation", time[counts], deviation)]
        plots.append(Plot(f"reference_{reference.name}", "time [s]", f"depth, {reference.name} [nm]", series, lower))
    notes = ["Compared from 15 % of the load on."]
    return Outcome(rows, plots, notes if rows else [f"{settings.reference} holds no reference curve."])


CASES = (Verification("reference", "Reference curves", run),)
