"""Whether load and depth confirm an instrument's own mark of contact; nothing of the contact finder is used for it.

The load P beyond what it reads without contact grows with the depth x beyond contact as x^m, with m from 1 (flat punch)
to 2 (cone), and hardly steeper than 2.5 with a film or hardening. While it becomes four times as large, therefore, x
becomes at least 4^(1 / 2.5) = 1.74 times as large; counted from a mark in air, less. What the load reads without
contact is linear in time and depth over the middle of the approach, and holds its value from the mark on. The numbers
were fixed before the first run on a file, which found two faults, mended since: one step of coarse sampling counted
as a steep rise, and a line in time alone missed the tilt of an approach that slows down.

- contradicted, where the load has left its noise before the mark, or becomes four times as large on a way that is less
  than 1.74 times as long, at any load from 6 standard deviations of its noise to an eighth of its largest;
- not judged, where 6 standard deviations of its noise are more than that eighth;
- confirmed otherwise: by what lies before and after where twenty points or more lie before the mark, else by what lies
  after alone.

`python tests/helpers/contact_marks.py FILE ...` prints for each file which marks the intervals of the finder hold.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.ndimage import median_filter
from scipy.stats import binomtest

from indentation_files.channel_noise import noise_of
from indentation_files.contact_point import first_touch
from indentation_files.readers import VendorTest, read_each

BEFORE = 20
LEFT = 6.0
FOURFOLD = 4.0
STEEPEST = 2.5
HIGHEST = 1 / 8


def judged(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> str:
    """Return ``confirmed``, ``... by the load after it alone``, ``contradicted: WHY`` or ``not judged: WHY``."""
    begin, peak = int(np.argmax(time >= 0)), int(np.argmax(load))
    air = slice(begin // 5, begin - begin // 5)
    told = begin >= BEFORE
    terms = np.column_stack([np.ones_like(time), np.minimum(time, 0.0), np.minimum(depth - depth[begin], 0.0)])
    line = np.linalg.lstsq(terms[air], load[air], rcond=None)[0] if told else np.array([load[begin], 0.0, 0.0])
    excess = load - terms @ line
    noise = float(np.std(excess[air])) if told else 0.0
    excess = median_filter(excess, 5, mode="nearest")
    noise = max(noise, noise_of(load[: peak + 1]), 1e-7 * float(np.ptp(load)))
    if told and float(np.median(excess[begin - 4 : begin + 1])) > LEFT * noise:
        return "contradicted: the load has left its noise before"
    way = depth - depth[begin]
    step = float(np.median(np.abs(np.diff(depth[begin : peak + 1]))))
    error = 2 * noise_of(depth[: peak + 1])
    level = LEFT * noise
    if level > HIGHEST * load.max():
        return "not judged: the noise is too strong"
    while level < HIGHEST * load.max():
        near, far = (_reached(excess, way, each, begin, peak) for each in (level, FOURFOLD * level))
        if near - error > 0 and far + step + error < FOURFOLD ** (1 / STEEPEST) * (near - error):
            return f"contradicted: {level:.2g} mN after {near:.3g} nm, four times as much after {far:.3g} nm"
        level *= 2
    return "confirmed" if told else "confirmed by the load after it alone"


def _reached(excess: np.ndarray, way: np.ndarray, level: float, begin: int, peak: int) -> float:
    """Return how deep beyond the mark the load last lies below a level on its way to the peak [nm]."""
    below = np.flatnonzero(excess[begin:peak] < level)
    return float(way[begin + int(below[-1])]) if len(below) else 0.0


def report(file: Path) -> None:
    """Print each mark of a file, what load and depth say of it, and the finder's interval counted from it."""
    held: dict[str, list[bool]] = {}
    for test in read_each(file, contact="none"):
        if not isinstance(test, VendorTest) or not test.marked:
            continue
        r = test.recording
        point, mark = first_touch(r.time, r.load, r.depth), float(np.interp(0.0, r.time, r.depth))
        verdict = judged(r.time, r.load, r.depth)
        held.setdefault(verdict.partition(":")[0], []).append(point.lower <= mark <= point.upper)
        ends = " ".join(f"{depth - mark:.1f}" for depth in (point.lower, point.depth, point.upper))
        print(f"{test.name}: {verdict}; found at {ends} nm")
    for verdict, holds in held.items():
        low, high = binomtest(sum(holds), len(holds)).proportion_ci(method="wilson")
        print(f"{file.name}: {verdict}: {sum(holds)} of {len(holds)} held ({low:.3f} to {high:.3f})")


if __name__ == "__main__":
    for given in sys.argv[1:]:
        report(Path(given))
