r"""The frame's compliance from the tops of unloadings at several loads, whatever the shape of the tip.

    C = dh/dP = C_f + sqrt(pi)/(2 beta E_r) * sqrt(H/P) = C_f + k / sqrt(P)

Contact area is load over hardness, so the area function does not enter, nor does the zero point: both only move depths.
Hardness and modulus must not depend on depth. For a sharp tip on a body without a length that holds exactly, plasticity
and creep included, when the cycles take equal times. Each test has a k of its own, because sites differ.

An error of the depth counts the more, the smaller the load: C sqrt(P) scatters as 1 / sqrt(P) does, and is weighed so.
That also keeps the lowest loads, where a blunt tip breaks the law, from deciding.

Sources: D.L. Joslin and W.C. Oliver, J. Mater. Res. 5 (1990) 123-126 (P/S^2 holds no area); W.C. Oliver and G.M. Pharr,
J. Mater. Res. 7 (1992) 1564-1583, equations (8) and (9); J.L. Hodges and E.L. Lehmann, Ann. Math. Stat. 34
(1963) 598-611.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from indentation_files.correlated_errors import Series, shared_coefficient
from indentation_files.segments import Segment
from palpate.classical.oliver_pharr import fit_unloading
from palpate.errors import InputError

LOWEST = 0.01  # of the largest load, below which no stiffness of an oscillation is taken; chosen, like all that follow
STARTS = (0.0, 0.05, 0.1, 0.2)  # of a test's largest load, below which unloadings are left out
MAIN = 0.05  # the one of them that gives the estimate
SPAN = 3.0  # least ratio of the loads of a test
FEWEST = 4  # unloadings, or loads, of a test
MANY = 6  # tests, from which on single slopes are combined: Wilcoxon's 95 % interval takes six
POINTS = 8  # of an unloading above a quarter of its load
TOP = 0.95  # of the highest load so far, from which an unloading counts
ROUNDS = 3  # in which the frame's deflection is taken off and found anew
LEVELS = 24  # equal steps of sqrt(P)


@dataclass(frozen=True)
class FrameCompliance:
    """A frame's compliance beyond what was corrected.

    Attributes
    ----------
    compliance, lower, upper
        Estimate and 95 % interval [nm/mN].
    unloadings
        Number of unloadings, or of loads at which the stiffness was measured continuously, that it rests on.
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


def frame_of(tests: Sequence[tuple[np.ndarray, np.ndarray, Sequence[Segment]]]) -> FrameCompliance | None:
    """Return the frame's compliance from whole tests (load [mN], depth [nm], segments) on one material.

    Unloading follows a power law once the frame's deflection is taken off: what was found is taken off, and found anew.
    Tests are left out whose own unloadings do not determine it; each of the others has four or more, from loads that
    differ by a factor of three.
    """
    known, found = 0.0, None
    for _ in range(ROUNDS):
        seen = [tops(load, depth - known * load, parts) for load, depth, parts in tests]
        usable = [pair for pair in seen if _sufficient(pair[0])]
        if not usable:
            return None
        left = frame_compliance(usable)
        known, lower, upper = (known + value for value in (left.compliance, left.lower, left.upper))
        found = FrameCompliance(known, lower, upper, left.unloadings)
    return found


def frame_by_oscillation(tests: Sequence[tuple[np.ndarray, np.ndarray]]) -> FrameCompliance | None:
    """Return the frame's compliance from the stiffness measured by a small oscillation while the load grows.

    P/S^2 without the frame's part is then the same at every depth. Points are taken from a hundredth of the largest
    load on, as medians over 24 equal steps of sqrt(P), because neighbours share their error. The oscillation may see
    another frame than the slow load does: it moves less of the instrument.

    Parameters
    ----------
    tests
        Load [mN] and measured stiffness [mN/nm] (n,) of each test; NaN where none was measured.
    """
    seen = []
    for load, stiffness in tests:
        peak = int(np.argmax(load))
        rising = np.flatnonzero(np.isfinite(stiffness) & (stiffness > 0) & (load > LOWEST * load[peak]))
        rising = rising[rising <= peak]
        if len(rising) < LEVELS * FEWEST:
            continue
        root = np.sqrt(load[rising])
        step = np.minimum((LEVELS * (root - root.min()) / np.ptp(root)).astype(int), LEVELS - 1)
        blocks = [rising[step == k] for k in np.unique(step)]
        values = [(np.median(load[block]), np.median(1.0 / stiffness[block])) for block in blocks]
        loads, compliances = np.array(values).T
        if _sufficient(loads):
            seen.append((loads, compliances))
    return frame_compliance(seen) if seen else None


def frame_compliance(tops_of_tests: Sequence[tuple[np.ndarray, np.ndarray]]) -> FrameCompliance:
    """Return the frame's compliance from the tops (loads [mN], compliances [nm/mN]) of tests with enough of them.

    C sqrt(P) is a straight line in sqrt(P) with the slope C_f. From six tests on, the slopes of single tests are
    combined by Hodges and Lehmann's estimate with Wilcoxon's interval, which one bad site does not move; fewer are
    fitted together, with an interval that allows for errors correlated along a test
    (`indentation_files.correlated_errors`). Either is widened to how the slope moves when loads below 5, 10 or 20 % of
    each test's largest are left out or all are kept: where hardness depends on depth, it shows there.
    """
    found = {start: _from_start(tops_of_tests, start) for start in STARTS}
    slope, lower, upper, count = found[MAIN] or found[STARTS[0]] or (np.nan, np.nan, np.nan, 0)
    others = [entry[0] for entry in found.values() if entry]
    return FrameCompliance(slope, min(lower, *others), max(upper, *others), count)


def _sufficient(loads: np.ndarray, start: float = 0.0) -> bool:
    """Return whether the loads (n,) from a share of the largest on are enough and different enough."""
    kept = loads[loads >= start * loads.max()] if len(loads) else loads
    return len(kept) >= FEWEST and kept.max() >= SPAN * kept.min()


def _from_start(
    tops_of_tests: Sequence[tuple[np.ndarray, np.ndarray]], start: float
) -> tuple[float, float, float, int] | None:
    """Return slope, 95 % interval and number of points from a share of the largest load on, or None without enough."""
    lines = [_line(loads, values, start) for loads, values in tops_of_tests if _sufficient(loads, start)]
    if not lines:
        return None
    count = sum(len(line.values) for line in lines)
    if len(lines) >= MANY:
        return (*hodges_lehmann(np.array([_slope(line) for line in lines])), count)
    found = shared_coefficient(lines)
    return found.value, found.value - found.half, found.value + found.half, count


def _line(loads: np.ndarray, compliances: np.ndarray, start: float) -> Series:
    """Return C P = C_f P + k sqrt(P) of one test, whose errors are those of the depth."""
    kept = loads >= start * loads.max()
    load = loads[kept]
    return Series(load * compliances[kept], load, np.sqrt(load)[:, None])


def _slope(line: Series) -> float:
    """Return the coefficient of one test alone, by least squares."""
    return float(np.linalg.lstsq(np.column_stack([line.common, line.own]), line.values, rcond=None)[0][0])


def hodges_lehmann(values: np.ndarray) -> tuple[float, float, float]:
    """Return the median of the means of all pairs of `values` (n,), and Wilcoxon's 95 % interval."""
    first, second = np.triu_indices(len(values))
    means = np.sort(0.5 * (values[first] + values[second]))
    ways = np.ones(1)
    for rank in range(1, len(values) + 1):
        ways = np.append(ways, np.zeros(rank)) + np.append(np.zeros(rank), ways)
    out = max(int(np.searchsorted(np.cumsum(ways) / ways.sum(), 0.025)) - 1, 0)
    return float(np.median(means)), float(means[out]), float(means[-1 - out])
