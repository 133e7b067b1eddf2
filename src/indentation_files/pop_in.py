"""Sudden jumps of the depth while the load grows: pop-ins of crystals, cracks, a tip that slips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from indentation_files.channel_noise import noise_of
from indentation_files.recording import Recording

AROUND = 11  # points before and behind, the larger of whose median rates is that of the loading itself
SIDE = AROUND // 2
FASTER = 6.0  # times that rate, from which on the depth jumps
CLEAR = 8.0  # standard deviations of the depth's noise that a jump exceeds
LEAST = 0.005  # of the largest depth, likewise
FIRST = 0.003  # of the largest load, below which the depth grows fast by itself


@dataclass(frozen=True)
class PopIn:
    """A jump of the depth at a load [mN]: growth beyond what the loading around it makes it grow [nm]."""

    load: float
    jump: float


def pop_ins(recording: Recording) -> list[PopIn]:
    """Return the jumps of the depth on the way to the largest load, the first one first; none in short recordings."""
    peak = int(np.argmax(recording.load))
    if peak < 4 * AROUND:
        return []
    time, load, depth = (channel[: peak + 1] for channel in (recording.time, recording.load, recording.depth))
    step, growth = np.diff(time), np.diff(depth)
    rate = np.repeat(growth / step, [1 + SIDE, *[1] * (peak - 2), 1 + SIDE])
    around = median_filter(rate, AROUND, mode="nearest")
    before, after = around[:peak], around[2 * SIDE :]
    usual = np.maximum(before, after) * step
    beyond = growth - 0.5 * (before + after) * step
    sudden = (growth > FASTER * usual) & (load[:-1] > FIRST * load[-1]) & (usual > 0.0)
    if not sudden.any():
        return []
    starts = np.flatnonzero(np.diff(np.concatenate([[False], sudden, [False]]).astype(int)))
    least = max(CLEAR * noise_of(depth), LEAST * float(depth.max()))
    found = [(first, float(beyond[first:last].sum())) for first, last in zip(starts[::2], starts[1::2], strict=True)]
    return [PopIn(float(load[first]), jump) for first, jump in found if jump > least]
