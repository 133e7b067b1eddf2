"""An estimate of what a law does under a constant stress, from which meshes take their size before a simulation."""

from __future__ import annotations

import math

import numpy as np

from palpate.materials.flow.registry import FLUIDITIES, STRENGTHS
from palpate.materials.flow.row import (
    BACK_STRESS,
    CREEP,
    FLOWING,
    FUNCTION,
    HARDENING,
    LINEAR,
    NUMBERS,
    SHARE,
    SHEAR,
    VOIGT,
    YIELD,
    blocks_of,
    yields,
)

HELD = 2.0 / 3.0  # of the yield stress that a mean contact pressure exceeds the pressure in the material by


def secant_compliance(row: np.ndarray, q: float, pressure: float, duration: float) -> float:
    """Return the deviatoric strain over the stress q = sqrt(s:s/2) [1/GPa] after it has acted for a `duration` [s].

    Voigt elements count as fully retarded, and plastic flow not at all; a back stress as if q were what it leaves.

    Parameters
    ----------
    row : ndarray, shape (c,)
        The law, see `palpate.materials.flow.row`.
    q
        Invariant of the stress [GPa].
    pressure
        [GPa], positive in compression.
    duration
        [s].
    """
    flow, linear = 0.0, 0.0
    for term in blocks_of(row):
        if term.kind in (CREEP, HARDENING, VOIGT):
            gain = q * duration / FLOWING if term.kind == HARDENING else 0.0
            value, *_ = FLUIDITIES[term.function](row, term.at + NUMBERS, q, math.log(q), pressure, 0.0, gain)
            flow += value * (1.0 if term.kind == VOIGT else duration)
        elif term.kind == LINEAR:
            linear += row[term.at + NUMBERS]
    return float(0.5 / row[SHEAR] + row[SHARE] * (flow / (1.0 + _stiffening(row) * flow) + linear))


def flow_stress(row: np.ndarray, strain: float, pressure: float) -> float:
    """Return the yield stress [GPa] after a plastic `strain` under a contact, whose mean pressure is 2.8 times it.

    It is infinite without one. The contact's pressure is at most `pressure` [GPa].
    """
    if not yields(row):
        return math.inf
    at = int(row[YIELD])
    stress = 0.0
    for _ in range(20):
        within = min((2.8 - HELD) * stress, pressure)
        stress, *_ = STRENGTHS[int(row[at + FUNCTION])](row, at + NUMBERS, strain, within)
    return float(stress + 1.5 * _stiffening(row) * strain)


def _stiffening(row: np.ndarray) -> float:
    """Return the back stress over the strain that brings it about [GPa]."""
    at = int(row[BACK_STRESS])
    return 2.0 / 3.0 * float(row[at + NUMBERS]) if at else 0.0
