"""The pull of a surface that holds the tip while it leaves."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from indentation_files.borne_load import NEAR_START
from indentation_files.channel_noise import noise_of
from indentation_files.recording import Recording

PULLED = 0.02  # of the largest load, chosen: a pull on the tip that is reported
CLEAR = 10.0  # standard deviations of the load's noise, likewise


def pull_off(recording: Recording) -> float:
    """Return how far the load falls below that without contact, after its largest [mN]; 0 where little or within noise.

    What the load reads without contact is taken from an approach, and is zero where a recording begins at contact.
    """
    load, peak = recording.load, int(np.argmax(recording.load))
    free = float(np.median(load[:NEAR_START])) if recording.time[0] < 0.0 else 0.0
    pull = free - float(median_filter(load, 3, mode="nearest")[peak:].min())
    return pull if pull > max(PULLED * (load[peak] - free), CLEAR * noise_of(load)) else 0.0
