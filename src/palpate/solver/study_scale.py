"""The size of a study, in which amplitudes of mechanisms are searched for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from indentation_files.contact_interval import joint_interval
from indentation_files.recording import Recording
from palpate.configuration.study_file import Study
from palpate.mechanisms import Scale
from palpate.solver.axisymmetric.contact_size import contact_range, expected_load, loaded_time, mean_pressure
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.protocol import Protocol
from palpate.study.specification import of_equivalent_cone

OFFSET = "zero_offset"
SLOPE = 0.36  # of a Berkovich pyramid's equivalent cone, at which materials are compared


def middle(study: Study) -> dict[str, float]:
    """Return the material in the middle of the study's grid."""
    return {name: float(np.mean(levels)) for name, levels in study.levels.items()}


def scale_of(study: Study) -> Scale:
    """Return the size of the study, estimated from its middle material: that of its tests with its own tip, if any."""
    cell, tests = middle(study), study.by_tip(study.calibrated)
    of_tip = tests.get("", study.calibrated)
    largest = max(of_tip, key=lambda condition: condition.protocol.largest_drive)
    specification = of_equivalent_cone(study.specification(cell, largest))
    tip = specification.indenter
    radius = contact_range(specification.specimen, tip, largest.protocol)[1]
    slope = Profile.of(tip).slope_for(radius) if tip.area else tip.slope
    slope = slope if np.isfinite(slope) else radius / (1e-3 * tip.radius)
    return Scale(
        depth=1.2e3 * radius * slope,
        load=expected_load(specification.specimen.coefficients, tip, largest.protocol),
        modulus=specification.parameters["youngs_modulus"],
        duration=max(float(c.protocol.sample_time[-1]) for c in study.calibrated),
        loading_time=min(longest_rise(c.protocol) for c in study.calibrated),
        half_angle=tip.half_angle,
        pressure=mean_pressure(specification.coefficients, slope, loaded_time(largest.protocol)),
        stated=study.diagnosis.ranges,
        half_angles={name: tip.equivalent_cone.half_angle for name, tip in study.tips.items()},
        instrument=study.instrument.prior if study.instrument else None,
    )


def with_contact_sought(scale: Scale, recordings: Iterable[Recording]) -> Scale:
    """Return the scale with the recordings' own intervals of contact as the range of their zero offsets.

    A range that the study states stays; nothing changes where a recording's contact was not sought.
    """
    interval = joint_interval(recordings)
    if interval is None or interval[0] == interval[1] or OFFSET in scale.stated:
        return scale
    return replace(scale, stated={**scale.stated, OFFSET: {"offset": interval}})


def longest_rise(protocol: Protocol) -> float:
    """Return the duration [s] of the uninterrupted rise that gains the most, however many corners it has."""
    steps = np.diff(protocol.knot_drive)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], steps > 0, [False]]).astype(int)))
    runs = ends.reshape(-1, 2)
    first, last = max(runs, key=lambda run: protocol.knot_drive[run[1]] - protocol.knot_drive[run[0]])
    return float(protocol.knot_time[last] - protocol.knot_time[first])
