r"""The frame's compliance from the tops of unloadings at several loads, whatever the shape of the tip.

    C = dh/dP = C_f + sqrt(pi)/(2 beta E_r) * sqrt(H/P) = C_f + k / sqrt(P)

Contact area is load over hardness, so the area function does not enter, nor does the zero point: both only move depths.
Hardness and modulus must not depend on depth. For a sharp tip on a body without a length that holds exactly, plasticity
and creep included, when the cycles take equal times.

Sources: D.L. Joslin and W.C. Oliver, J. Mater. Res. 5 (1990) 123-126 (P/S^2 holds no area); W.C. Oliver and G.M. Pharr,
J. Mater. Res. 7 (1992) 1564-1583, equations (8) and (9).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from palpate.classical.oliver_pharr import fit_unloading
from palpate.errors import InputError
from palpate.segments import Segment

STARTS = (0.0, 0.05, 0.1, 0.2)
MAIN = 0.05
SPAN = 3.0
FEWEST = 4
POINTS = 8
TOP = 0.95
ROUNDS = 3


@dataclass(frozen=True)
class FrameCompliance:
    """A frame's compliance beyond what was corrected.

    Attributes
    ----------
    compliance, lower, upper
        Estimate and 95 % interval [nm/mN].
    unloadings
        Number of unloadings that it rests on.
    """

    compliance: float
    lower: float
    upper: float
    unloadings: int


def tops(load: np.ndarray, depth: np.ndarray, parts: Iterable[Segment]) -> tuple[np.ndarray, np.ndarray]:
    """Return largest load [mN] and compliance dh/dP there [nm/mN] of each unloading from the highest load so far.

    Unloadings of fewer than eight points above a quarter of their load are left out.

    Parameters
    ----------
    load, depth : ndarray, shape (n,)
        [mN], [nm].
    """
    loads, compliances = [], []
    for part in parts:
        inside = slice(part.first, part.last + 1)
        peak = float(load[inside].max()) if part.kind == "unloading" else 0.0
        if peak <= 0.0 or peak < TOP * load[: part.last + 1].max():
            continue
        begin = part.first + int(np.argmax(load[inside]))
        down = slice(begin, part.last + 1)
        if np.count_nonzero(load[down] >= 0.25 * peak) < POINTS:
            continue
        try:
            found = fit_unloading(load[down], depth[down])
        except InputError:
            continue
        loads.append(peak)
        compliances.append(1.0 / found.stiffness)
    return np.array(loads), np.array(compliances)


def frame_compliance(loads: np.ndarray, compliances: np.ndarray) -> FrameCompliance | None:
    """Return the frame's compliance from the unloadings of all tests on one material, or None where they cannot tell.

    C sqrt(P) is a straight line in sqrt(P) with the slope C_f; its points have about equal errors. The interval is
    Student's, widened to how the slope moves when loads below 5, 10 or 20 % of the largest are left out or all are
    kept: where hardness depends on depth, as it does for a shallow contact of a blunt tip, it shows there. At least
    four unloadings whose loads differ by a factor of three are needed.

    Parameters
    ----------
    loads, compliances : ndarray, shape (n,)
        From `tops` [mN], [nm/mN].
    """
    if len(loads) < FEWEST or loads.max() < SPAN * loads.min():
        return None
    slopes = {}
    for start in STARTS:
        kept = loads >= start * loads.max()
        if kept.sum() >= FEWEST and loads.max() >= SPAN * loads[kept].min():
            slopes[start] = _slope(np.sqrt(loads[kept]), compliances[kept] * np.sqrt(loads[kept])), int(kept.sum())
    (slope, half), count = slopes.get(MAIN, slopes[STARTS[0]])
    others = [value for (value, _), _ in slopes.values()]
    return FrameCompliance(slope, min(slope - half, *others), max(slope + half, *others), count)


def frame_of(tests: Sequence[tuple[np.ndarray, np.ndarray, Sequence[Segment]]]) -> FrameCompliance | None:
    """Return the frame's compliance from whole tests (load [mN], depth [nm], segments) on one material.

    Unloading follows a power law once the frame's deflection is taken off: what was found is taken off, and found anew.

    Tests whose own unloadings cannot tell are left out.
    """
    known, found = 0.0, None
    for _ in range(ROUNDS):
        seen = [tops(load, depth - known * load, parts) for load, depth, parts in tests]
        telling = [pair for pair in seen if frame_compliance(*pair) is not None]
        if not telling:
            return None
        loads, compliances = (np.concatenate(channel) for channel in zip(*telling, strict=True))
        left = frame_compliance(loads, compliances)
        if left is None:
            return None
        known, lower, upper = (known + value for value in (left.compliance, left.lower, left.upper))
        found = FrameCompliance(known, lower, upper, left.unloadings)
    return found


def _slope(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Return the slope of a straight line and half its 95 % interval."""
    line = stats.linregress(x, y)
    return float(line.slope), float(stats.t.ppf(0.975, len(x) - 2) * line.stderr)
