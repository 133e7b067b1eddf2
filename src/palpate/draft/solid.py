"""What recordings tell of a solid without simulations: its modulus, and whether their units can be right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from palpate.analytic import hertz, sneddon
from palpate.classical import AreaFunction, TipConstants, oliver_pharr
from palpate.draft.stated import Stated
from palpate.errors import InputError
from palpate.recordings.readers.zero import begins_off_contact
from palpate.recordings.recording import Recording

POISSON_RATIO = 0.35
BERKOVICH_CONE = 70.3
STIFFEST = 1200.0  # GPa, a little above diamond
UNLIKE = 3.0  # ratio of two tests' moduli from which on they seem to be of two materials
NOTHING = Stated()


@dataclass(frozen=True)
class Solid:
    """What recordings tell of a solid without simulations, medians of the tests [GPa].

    Parameters
    ----------
    secant
        Modulus of an elastic half-space that is as deep at the largest load (Sneddon 1965, Hertz 1882).
    modulus, hardness
        By unloading (W.C. Oliver and G.M. Pharr, J. Mater. Res. 7 (1992) 1564-1583); NaN where no test has one that
        tells them.
    """

    secant: float
    modulus: float
    hardness: float

    @classmethod
    def of(cls, recordings: Sequence[Recording], radius: float | None, stated: Stated = NOTHING) -> Solid:
        """Analyse recordings under a sphere of a `radius` [nm], or a Berkovich tip, whose area function may be stated.

        Raises
        ------
        InputError
            When the tip has not sunk in at the largest load.
        """
        area = AreaFunction(stated.area) if stated.area else None
        if radius is not None:
            area = AreaFunction((-np.pi, 2.0 * np.pi * radius))
        poisson_ratio = stated.poisson_ratio or POISSON_RATIO
        tip, unloadings = TipConstants(area) if area else None, []
        for recording in recordings:
            with suppress(InputError):
                unloadings.append(oliver_pharr(recording.load, recording.depth, poisson_ratio, tip=tip))
        told = [(found.modulus, found.hardness) for found in unloadings] or [(math.nan, math.nan)]
        secant = np.median([secant_modulus(recording, radius, stated) for recording in recordings])
        return cls(float(secant), *(float(value) for value in np.median(told, axis=0)))


def peak_of(recording: Recording) -> tuple[float, float]:
    """Return the largest load [mN] and the depth there [nm]; raises `InputError` when the tip has not sunk in."""
    peak = int(np.argmax(recording.load))
    depth = float(recording.depth[peak])
    if not depth > 0.0:
        remedy = "let the depth begin at contact"
        raise InputError(f"the depth is {depth:.4g} nm at the largest load", remedy=remedy, file=recording.name)
    return float(recording.load[peak]), depth


def secant_modulus(recording: Recording, radius: float | None, stated: Stated = NOTHING) -> float:
    """Return the modulus [GPa] of an elastic body that is as deep at the largest load, under a sphere or a cone."""
    load, depth = peak_of(recording)
    poisson_ratio = stated.poisson_ratio or POISSON_RATIO
    if radius is not None:
        return load / float(hertz.load(depth, 1.0, poisson_ratio, radius))
    return load / float(sneddon.load(depth, 1.0, poisson_ratio, BERKOVICH_CONE))


def check_units(recordings: Sequence[Recording], radius: float | None, stated: Stated = NOTHING) -> None:
    """Refuse a recording of a solid stiffer than any: its unit is mistaken, or its columns are swapped.

    A depth mistaken by 1000 changes the modulus by a million under a cone, a load by 1000. The other way round nothing
    can be refused, as gels are a million times softer than plastics.

    Raises
    ------
    InputError
        With the recording's name as the file.
    """
    for recording in recordings:
        modulus = secant_modulus(recording, radius, stated)
        if modulus > STIFFEST:
            load, depth = peak_of(recording)
            raise InputError(
                f"the depth is {depth:.4g} nm at {load:.4g} mN, as of a body of {modulus:.3g} GPa, stiffer than "
                "diamond; are depths in micrometres, or loads in uN, or the two swapped?",
                remedy="write depths in nm and loads in mN, or name the columns and their units "
                "(--columns time=...,load=...,depth=... --units depth=um)",
                file=recording.name,
                place="depth_nm",
            )


def unlike(recordings: Sequence[Recording], radius: float | None, stated: Stated = NOTHING) -> list[str]:
    """Return a remark when tests of one draft seem to be of different materials, else none.

    Where one begins off contact, its depth is not the body's, and says nothing.
    """
    if any(map(begins_off_contact, recordings)):
        return []
    moduli = [secant_modulus(recording, radius, stated) for recording in recordings]
    soft, stiff = int(np.argmin(moduli)), int(np.argmax(moduli))
    if moduli[stiff] <= UNLIKE * moduli[soft]:
        return []
    return [
        f"the tests look like different materials: elastic bodies as deep have moduli from {moduli[soft]:.3g} GPa "
        f"({recordings[soft].name}) to {moduli[stiff]:.3g} GPa ({recordings[stiff].name}); draft a study of each"
    ]
