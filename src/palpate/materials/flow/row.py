"""A law as a row of numbers, which kernels read term by term.

A row holds the elastic moduli and the share of the volume that flows, then a block for each term: its kind, the number
of its function, the length of the block, its retardation time, and the numbers of its function. Terms whose strain
depends on the stress alone come first, so that the radial equation reads no further than `ACTIVE`. The one hardening
variable alpha of a law is that of its term of kind `HARDENING` or `PLASTIC`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

SHEAR, BULK, SHARE, PRESSED, YIELD, STATE, BACK_STRESS, ACTIVE, FIRST = range(9)
KIND, FUNCTION, SIZE, TIME, NUMBERS = range(5)  # of a block
CREEP, HARDENING, VOIGT, PLASTIC, LINEAR, BACK = range(6)  # kinds, in the order of their blocks
COMPLIANCE, LOG_RESISTANCE, INVERSE_RESISTANCE, STIFFENING, SPLIT, FACTORS = range(6)  # of the weights
CLOSING, OPENING, DECAY, GAIN, PER_TERM = range(5)  # of the weights of a term
NO_SHARE = 1e-12  # share of the volume that flows, below which there is none
FLOWING = 0.5 * math.sqrt(3.0)  # length sqrt(e:e/2) of a plastic strain deviator over the equivalent plastic strain


@dataclass(frozen=True)
class Block:
    """A term within a row: where it begins, its kind, and the number of its function."""

    at: int
    kind: int
    function: int


def packed(shear: float, bulk: float, blocks: Iterable[list[float]], pressed: bool) -> np.ndarray:
    """Return the row (c,) of a law from its moduli [GPa] and the blocks of its terms, in any order.

    Parameters
    ----------
    shear, bulk
        Shear and bulk modulus [GPa].
    blocks
        See `block`.
    pressed
        Whether any term depends on the pressure.
    """
    row = [shear, bulk, 1.0, float(pressed), 0.0, 0.0, 0.0, float(FIRST)]
    for block in sorted(blocks, key=lambda block: block[KIND]):
        if block[KIND] == PLASTIC:
            row[YIELD] = len(row)
        if block[KIND] == BACK:
            row[BACK_STRESS] = len(row)
        if block[KIND] in (HARDENING, PLASTIC):
            row[STATE] = 1.0
        row += block
        if block[KIND] <= VOIGT:
            row[ACTIVE] = len(row)
    return np.array(row)


def block(kind: int, function: int, time: float, numbers: Iterable[float]) -> list[float]:
    """Return the block of a term.

    Parameters
    ----------
    kind
        Such as `CREEP` or `PLASTIC`.
    function
        Number of the function, see `palpate.materials.flow.registry`.
    time
        Retardation time [s]; zero for other kinds.
    numbers
        Parameters of the function.
    """
    numbers = [float(number) for number in numbers]
    return [float(kind), float(function), float(NUMBERS + len(numbers)), time, *numbers]


def blocks_of(row: np.ndarray) -> Iterator[Block]:
    """Yield the terms of a row (c,)."""
    at = FIRST
    while at < len(row):
        yield Block(at, int(row[at + KIND]), int(row[at + FUNCTION]))
        at += int(row[at + SIZE])


def structure(row: np.ndarray) -> tuple[tuple[int, int], ...]:
    """Return kind and function of each term: what laws that are simulated side by side must share."""
    return tuple((term.kind, term.function) for term in blocks_of(row))


def voigt_elements(row: np.ndarray) -> int:
    """Return the number of Voigt elements."""
    return sum(term.kind in (VOIGT, LINEAR) for term in blocks_of(row))


def creeps(row: np.ndarray) -> bool:
    """Whether the material flows, or recovers, under a constant stress below any yield stress."""
    return bool(row[SHARE] > 0.0) and any(term.kind in (CREEP, HARDENING, VOIGT, LINEAR) for term in blocks_of(row))


def yields(row: np.ndarray) -> bool:
    """Whether the material has a yield stress."""
    return bool(row[YIELD] > 0.0 and row[SHARE] > 0.0)


def step_weights(rows: np.ndarray, steps: np.ndarray | float, resistance: np.ndarray | float = 1.0) -> np.ndarray:
    """Return what a time step makes of laws.

    Parameters
    ----------
    rows : ndarray, shape (m, c) or (m, c, LANES)
        Laws of one structure.
    steps
        Length of the step [s], one for all or for each lane.
    resistance
        Factor on the stress at which the material flows, likewise.

    Returns
    -------
    ndarray, shape (m, w) or (m, w, LANES)
        Compliance of Hooke's law and of all linear Voigt elements at the end of the step, split for the back stress;
        logarithm and inverse of the resistance; the back stress over the strain that brings it about, and its split;
        then for each term with a rate the weights of what drives it at the end and at the start of the step, of its
        present strain, and what its rate at the end adds to alpha, see `palpate.materials.flow.radial`.
    """
    share, inverse = rows[:, SHARE], 1.0 / np.asarray(resistance)
    stiffening = np.zeros_like(share)
    compliance, factors = 0.5 / rows[:, SHEAR], []
    for term in blocks_of(rows[0].reshape(rows.shape[1], -1)[:, 0]):
        if term.kind in (CREEP, HARDENING):
            half = 0.5 * steps * share * inverse
            gain = 0.5 * steps / FLOWING if term.kind == HARDENING else 0.0
            factors += [half, half, np.ones_like(half), gain * np.ones_like(half)]
        elif term.kind in (VOIGT, LINEAR):
            x = steps / rows[:, term.at + TIME]
            decay, mean = np.exp(-x), np.divide(-np.expm1(-x), x, out=np.ones_like(x), where=x > 0.0)
            scale = share * inverse * (rows[:, term.at + NUMBERS] if term.kind == LINEAR else 1.0)
            factors += [scale * (1.0 - mean), scale * (mean - decay), decay, np.zeros_like(scale)]
            if term.kind == LINEAR:
                compliance = compliance + factors[-PER_TERM]
        elif term.kind == BACK:
            flowing = np.where(share > NO_SHARE, share, np.inf)
            stiffening = 2.0 / 3.0 * rows[:, term.at + NUMBERS] / (inverse * flowing)
    shape, split = np.ones_like(share), 1.0 / (1.0 + compliance * stiffening)
    common = [compliance * split, shape * -np.log(inverse), shape * inverse, stiffening, split]
    return np.stack([*common, *factors], axis=1)


def in_series(film: np.ndarray, substrate: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return the laws (m, c) of elements that hold a `share` (m,) of film, the rest substrate, under the same stress.

    The strains add (Reuss): compliances and the strains of all terms are averaged by volume. The substrate is elastic.
    """
    rows = np.tile(film, (len(share), 1))
    for k in (SHEAR, BULK):
        rows[:, k] = 1.0 / (share / film[k] + (1.0 - share) / substrate[k])
    rows[:, SHARE] = share * film[SHARE]
    return rows
