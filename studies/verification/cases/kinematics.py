"""Small against large strains, with and without friction: the table of differences beside CalculiX' own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth
from studies.verification.reference_materials import ALUMINIUM, BURGERS, CONE

WHERE = ("peak", "1/15 of the load")
WAYS = (("small", 0.0), ("small", 0.25), ("large", 0.0), ("large", 0.25))
NOTES = (
    "CalculiX 2.20 ran the same tests; allowed is the sum of what both programs state for the epoxy, 0.4 % each, and "
    "the difference of CalculiX' own depths on three meshes for the aluminium, 1.2 %.",
    "At large strains the law relates true stress to logarithmic strain, as Abaqus and its user materials do.",
)


@dataclass(frozen=True)
class Test:
    """A test that CalculiX ran too.

    Parameters
    ----------
    name, law, values, protocol
        What is pressed, and how.
    reference
        Depth [nm] at `WHERE` that CalculiX found, for each of `WAYS` that it ran.
    allowed
        Relative deviation.
    """

    name: str
    law: str
    values: Mapping[str, float]
    protocol: Protocol
    reference: Mapping[tuple[str, float], tuple[float, float]]
    allowed: float

    @property
    def samples(self) -> tuple[int, int]:
        """Samples at `WHERE`."""
        load = self.protocol.sample_load
        peak = int(np.argmax(load))
        return peak, peak + int(np.argmin(np.abs(load[peak:] - load[peak] / 15)))

    def curve(self, kinematics: str, friction: float) -> np.ndarray:
        """Return the simulated depth (n,) [nm] at the samples."""
        indenter = replace(CONE, friction=friction)
        return depth(
            Specification(self.law, self.values, indenter, self.protocol, kinematics=kinematics, accuracy="fine")
        )


EPOXY = Test(
    "epoxy",
    "nonlinear_burgers",
    BURGERS,
    trapezoid(1.0, 30.0, 0.0, 30.0, points=90),
    {
        ("small", 0.0): (499.3, 440.3),
        ("small", 0.25): (490.9, 428.1),
        ("large", 0.0): (491.7, 429.2),
        ("large", 0.25): (491.3, 426.4),
    },
    0.008,
)
METAL = Test(
    "aluminium",
    "bilinear_plasticity",
    ALUMINIUM,
    trapezoid(4.9, 15.0, 0.0, 15.0, points=90),
    {("small", 0.0): (675.0, 658.0), ("small", 0.25): (643.0, 625.0), ("large", 0.0): (617.0, 600.0)},
    0.012,
)


def run(settings: Settings) -> Outcome:
    """Tabulate depths, and what large strains and friction change in them."""
    rows: list[Row] = []
    plots = []
    for test in (EPOXY,) if settings.quick else (EPOXY, METAL):
        curves = {way: test.curve(*way) for way in WAYS}
        rows += [row for way in WAYS for row in _depths(test, way, curves[way])]
        rows += [row for way in WAYS[1:] for row in _differences(test, way, curves)]
        plots.append(_plot(test, curves))
    return Outcome(rows, plots, NOTES)


def _plot(test: Test, curves: Mapping[tuple[str, float], np.ndarray]) -> Plot:
    """Return the changes of depth over time, less the end of unloading, with CalculiX' as marks of the same colours.

    A label that begins with an underscore stays out of the legend.
    """
    last, time, plain = test.samples[1] + 1, test.protocol.sample_time, np.array(test.reference[WAYS[0]])
    series = []
    for way, curve in curves.items():
        change = 100 * (curve / curves[WAYS[0]] - 1)[:last]
        series.append(PlottedSeries(_label(way), time[:last], change))
    for way, depths in test.reference.items():
        change = 100 * (np.array(depths) / plain - 1)
        label = "CalculiX" if way == WAYS[0] else "_"
        series.append(PlottedSeries(label, time[list(test.samples)], change, True))
    return Plot(f"kinematics_{test.name}", "time [s]", f"change of depth, {test.name} [%]", series)


def _label(way: tuple[str, float]) -> str:
    return f"{way[0]} strain, friction {way[1]:g}"


def _depths(test: Test, way: tuple[str, float], curve: np.ndarray) -> list[Row]:
    expected = test.reference.get(way, (np.nan, np.nan))
    allowed, note = (test.allowed, "") if way in test.reference else (None, "CalculiX was not run")
    return [
        Row(f"{test.name}, {_label(way)}: depth at {where} [nm]", value, float(curve[k]), allowed, note)
        for where, value, k in zip(WHERE, expected, test.samples, strict=True)
    ]


def _differences(test: Test, way: tuple[str, float], curves: Mapping[tuple[str, float], np.ndarray]) -> list[Row]:
    plain, note = test.reference[WAYS[0]], "a ratio: errors that both share drop out"
    expected = np.array(test.reference.get(way, (np.nan, np.nan))) / plain
    return [
        Row(
            f"{test.name}, {_label(way)} against small strain, friction 0, {where}",
            float(value),
            float(curves[way][k] / curves[WAYS[0]][k]),
            test.allowed if way in test.reference else None,
            note,
        )
        for where, value, k in zip(WHERE, expected, test.samples, strict=True)
    ]


CASES = (Verification("kinematics", "Small against large strains, without and with friction", run),)
