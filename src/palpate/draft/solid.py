"""What recordings show of a solid without simulations: its modulus, how it flows, and whether units can be right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from indentation_files.recording import Recording
from palpate.classical import TipConstants, oliver_pharr
from palpate.draft.known_tip import KnownTip
from palpate.errors import InputError

POISSON_RATIO, OF_GELS = 0.35, 0.49  # guesses: of plastics; of gels and rubbers, which hardly change their volume
STIFFEST = 1200.0  # GPa, a little above diamond
SOFTEST = 1e-9  # GPa, chosen: no solid that bears a tip is softer than 1 Pa
STIFFEST_POLYMER = 8.0  # GPa; chosen: filled and highly drawn polymers apart, none is stiffer
LINEAR = 0.1  # GPa, chosen: softer solids are taken to creep linearly
HELD = 0.98  # of the largest load, at which a test counts as held


@dataclass(frozen=True)
class Solid:
    """What recordings show of a solid without simulations, medians of the tests.

    Parameters
    ----------
    secant
        Modulus of an elastic half-space that is as deep at the largest load (Sneddon 1965, Hertz 1882) [GPa].
    modulus, hardness
        By unloading (W.C. Oliver and G.M. Pharr, J. Mater. Res. 7 (1992) 1564-1583) under a diamond tip [GPa]; NaN
        where no test has one that gives them.
    creep
        How much the depth grows while the load is held, as a part of it; NaN where no load is held.
    returned
        Part of the work of loading that unloading gives back; NaN where a test is not unloaded.
    """

    secant: float
    modulus: float
    hardness: float
    creep: float = math.nan
    returned: float = math.nan

    @classmethod
    def of(cls, recordings: Sequence[Recording], tip: KnownTip, poisson_ratio: float) -> Solid:
        """Analyse recordings under a tip; raises `InputError` when the tip has not sunk in at the largest load."""
        moduli = [by_unloading(recording, tip, poisson_ratio) for recording in recordings]
        secant = np.median([secant_modulus(recording, tip, poisson_ratio) for recording in recordings])
        return cls(
            float(secant),
            *_medians([pair for pair in moduli if not math.isnan(pair[0])], 2),
            *_medians([(_creep(recording),) for recording in recordings], 1),
            *_medians([(_returned(recording),) for recording in recordings], 1),
        )

    @property
    def stiff(self) -> bool:
        """Whether it is stiffer than any polymer, by its unloading or, where that gives none, by its depth."""
        return max(self.secant, 0.0 if math.isnan(self.modulus) else self.modulus) > STIFFEST_POLYMER

    @property
    def soft(self) -> bool:
        """Whether it is as soft as gels and rubbers, which creep linearly."""
        return self.secant < LINEAR


def _medians(values: Sequence[tuple[float, ...]], count: int) -> list[float]:
    known = [each for each in values if not any(map(math.isnan, each))]
    return [float(value) for value in np.median(known, axis=0)] if known else [math.nan] * count


def by_unloading(recording: Recording, tip: KnownTip, poisson_ratio: float) -> tuple[float, float]:
    """Return modulus and hardness [GPa] by unloading, NaN where it does not give them."""
    with suppress(InputError):
        constants = TipConstants(tip.area_at(float(recording.depth.max())))
        found = oliver_pharr(recording.load, recording.depth, poisson_ratio, tip=constants)
        return found.modulus, found.hardness
    return math.nan, math.nan


def _creep(recording: Recording) -> float:
    """Return the relative growth of the depth from the first to the last point at the largest load."""
    held = np.flatnonzero(recording.load >= HELD * recording.load.max())
    first, last = held[0], held[-1]
    loading = recording.time[first]
    if recording.time[last] - loading < 0.05 * loading or last - first < 8:
        return math.nan
    return float(recording.depth[last] / recording.depth[first] - 1.0)


def _returned(recording: Recording) -> float:
    """Return the part of the work of loading, and of a hold, that unloading gives back (ISO 14577-1: eta_IT).

    It is NaN of a test whose load does not fall below a tenth of the largest.
    """
    largest = recording.load.max()
    if recording.load[-1] > 0.1 * largest:
        return math.nan
    end = int(np.flatnonzero(recording.load >= HELD * largest)[-1])
    done, given = (
        float(np.trapezoid(recording.load[part], recording.depth[part])) for part in (slice(end + 1), slice(end, None))
    )
    return -given / done if done > 0.0 else math.nan


def peak_of(recording: Recording) -> tuple[float, float]:
    """Return the largest load [mN] and the depth there [nm]; raises `InputError` when the tip has not sunk in."""
    peak = int(np.argmax(recording.load))
    depth = float(recording.depth[peak])
    if not depth > 0.0:
        remedy = "let the depth begin at contact"
        raise InputError(f"the depth is {depth:.4g} nm at the largest load", remedy=remedy, file=recording.name)
    return float(recording.load[peak]), depth


def secant_modulus(recording: Recording, tip: KnownTip, poisson_ratio: float = POISSON_RATIO) -> float:
    """Return the modulus [GPa] of an elastic body that is as deep at the largest load."""
    load, depth = peak_of(recording)
    of_unit_modulus = tip.elastic_load(depth, poisson_ratio)
    return load / of_unit_modulus if of_unit_modulus > 0.0 else math.inf


def check_unit(recording: Recording, tip: KnownTip) -> None:
    """Refuse a recording of a solid stiffer or softer than any: its unit is mistaken, or its columns are swapped.

    A depth mistaken by 1000 changes the modulus by a million under a cone, a load by 1000. Towards soft solids only
    larger mistakes show, as gels are a million times softer than plastics.

    Raises
    ------
    InputError
        With the recording's name as the file.
    """
    modulus = secant_modulus(recording, tip)
    if SOFTEST <= modulus <= STIFFEST:
        return
    if modulus > STIFFEST:
        body = f"{modulus:.3g} GPa, stiffer than diamond"
        question = "are depths in micrometres, or loads in uN, or the two swapped?"
        naming = "name the columns and their units (--columns time=...,load=...,depth=... --units depth=um)"
    else:
        body = f"{1e9 * modulus:.3g} Pa, softer than any gel"
        question = "is the unit of the depth or of the load another one?"
        naming = "name their units (--units depth=...,load=...)"
    load, depth = peak_of(recording)
    raise InputError(
        f"the depth is {depth:.4g} nm at {load:.4g} mN, as of a body of {body}; {question}",
        remedy=f"write depths in nm and loads in mN, or {naming}",
        file=recording.name,
        place="depth_nm",
    )
