"""The rings of nodes and the time steps that an indentation needs, at each accuracy."""

from __future__ import annotations

import numpy as np

from palpate.solver.axisymmetric.contact_size import contact_range
from palpate.solver.axisymmetric.mesh import LEAST_LOAD, Resolution, ring_radii
from palpate.study.indenter import Indenter
from palpate.study.protocol import LOAD, Protocol
from palpate.study.specimen import Specimen

RESOLUTIONS = {
    "standard": Resolution(growth=1.08, sectors=6),
    "medium": Resolution(
        growth=1.05, sectors=8, inner=0.15, far=3000.0, outer_growth=1.3, refine=2, load_growth=0.0625
    ),
    "fine": Resolution(growth=1.033, sectors=12, inner=0.1, far=4000.0, outer_growth=1.2, refine=2, load_growth=0.0625),
    "finest": Resolution(
        growth=1.025, sectors=16, inner=0.1, far=4000.0, outer_growth=1.2, refine=3, load_growth=0.03125
    ),
}
FEW_SECTORS = 4  # serve curves that are scaled: they lie too high or too low in the same proportion
GRADED_START = np.array([0.05, 0.1, 0.2, 0.35, 0.55, 0.77])  # of the first step, where it is divided
SAME = 1e-9  # of the test, within which a sample lies at a corner; less than `LEAST_STEP` of a protocol


def mesh_radii(specimen: Specimen, indenter: Indenter, protocol: Protocol, resolution: Resolution) -> np.ndarray:
    """Return the radii [um] of the rings of the mesh that an indentation needs.

    Parameters
    ----------
    specimen, indenter, protocol
        Body, tip and load history.
    resolution
        See `RESOLUTIONS`.
    """
    return ring_radii(*contact_range(specimen, indenter, protocol), resolution, not indenter.sharp)


def step_times(protocol: Protocol, resolution: Resolution, yields: bool = False) -> np.ndarray:
    """Return the ends of all time steps: samples, knots, steps between them, and a graded onset of loading.

    Where a body yields, a step in which the load grows by more than the resolution's share is divided: the direction of
    plastic flow is that at the end of a step, and a contact that spreads turns it meanwhile. Under a given displacement
    the load of a sharp tip grows with its square.
    """
    ends, corners = np.union1d(protocol.sample_time, protocol.knot_time[1:]), protocol.knot_time
    close = np.diff(ends) <= SAME * corners[-1]
    beside_corner = np.append(close, False) | np.append(False, close)
    ends = ends[~beside_corner | np.isin(ends, corners)]
    fine = divided(ends, np.full(len(ends), resolution.refine))
    onset = onset_of(protocol)
    first = fine[fine > onset * (1 + 1e-9)][0]
    start = onset + (first - onset) * GRADED_START
    if protocol.control != LOAD:
        start = onset + (first - onset) * np.sqrt(GRADED_START)
        start = start[protocol.drive_at(start) >= np.sqrt(LEAST_LOAD) * protocol.largest_drive]
    graded = np.union1d(fine, start)
    if not yields:
        return graded
    load = np.maximum(protocol.drive_at(graded), 0.0) ** (1 if protocol.control == LOAD else 2)
    before = np.append(0.0, load[:-1])
    growth = np.divide(load - before, before, out=np.zeros_like(load), where=before > 0.0)
    return divided(graded, np.maximum(np.ceil(growth / resolution.load_growth - 1e-6), 1).astype(int))


def steps_of_samples(ends: np.ndarray, protocol: Protocol) -> np.ndarray:
    """Return the number (n,) of the step, among those with such `ends` (m,) [s], that ends at each sample.

    That is the one that ends nearest to it: exactly there, or at the corner beside which it lies.
    """
    sample = protocol.sample_time
    after = np.minimum(np.searchsorted(ends, sample), len(ends) - 1)
    before = np.maximum(after - 1, 0)
    return np.where(sample - ends[before] < ends[after] - sample, before, after)


def onset_of(protocol: Protocol) -> float:
    """Return when the drive becomes positive [s]."""
    time, drive = protocol.knot_time, protocol.knot_drive
    first = int(np.flatnonzero(drive > 0)[0])
    return float(np.interp(0.0, drive[first - 1 : first + 1], time[first - 1 : first + 1])) if first else 0.0


def divided(ends: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return the ends of steps of which each is divided into so many equal parts; the first begins at zero."""
    starts = np.append(0.0, ends[:-1])
    return np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b, n in zip(starts, ends, parts, strict=True)])
