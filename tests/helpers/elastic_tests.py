"""Tests on an elastic half-space, by Sneddon's solution."""

import numpy as np

from indentation_files.recording import Recording
from palpate.analytic import sneddon
from palpate.study.protocol import trapezoid

MODULUS = 3.0


def elastic(load, loading, hold=0.0, name="test", noise=0.0, history=None):
    """Return a test on an elastic half-space under a Berkovich tip's equivalent cone (Sneddon)."""
    protocol = history or trapezoid(load, loading, hold, loading, points=400)
    time = np.append(0.0, protocol.sample_time)
    force = np.append(0.0, protocol.sample_load)
    depth = sneddon.depth(force, MODULUS, 0.35, 70.3)
    force = force + noise * load * np.random.default_rng(len(name)).standard_normal(len(force)) * (force > 0)
    return Recording(time, np.maximum(force, 0.0), depth, name=name)
