"""A first study of recordings: what they say is written down, what they do not say is guessed and marked as such."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np

from palpate.analytic import hertz, sneddon
from palpate.classical import AreaFunction, oliver_pharr
from palpate.errors import InputError
from palpate.grouping import Group
from palpate.materials import LAWS
from palpate.recording import Recording
from palpate.stated import Stated

POISSON_RATIO = 0.35
BERKOVICH_CONE = 70.3
EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml
POINTS = 128
NOTHING = Stated()
STUDY = Template("""\
# A first study, drafted from recordings. Load histories and replicates are theirs; what says `guess` is not.
# docs/study.md tells every key.
study: $name
seed: 1
cells_per_job: 64

$material
# guess: $reason;
# where an estimate ends at the edge of its range, widen it
parameters:
$parameters
design: {kind: sobol, points: $points}

$indenter

conditions:
$conditions

recordings: {lab: $recordings}

$diagnosis
""")


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
        unloadings = []
        for recording in recordings:
            with suppress(InputError):
                unloadings.append(oliver_pharr(recording.load, recording.depth, poisson_ratio, area=area))
        told = [(found.modulus, found.hardness) for found in unloadings] or [(math.nan, math.nan)]
        secant = np.median([_secant_modulus(recording, radius, poisson_ratio) for recording in recordings])
        return cls(float(secant), *(float(value) for value in np.median(told, axis=0)))


def _secant_modulus(recording: Recording, radius: float | None, poisson_ratio: float) -> float:
    peak = int(np.argmax(recording.load))
    depth = float(recording.depth[peak])
    if not depth > 0.0:
        remedy = "let the depth begin at contact"
        raise InputError(f"the depth is {depth:.4g} nm at the largest load", remedy=remedy, file=recording.name)
    unit = sneddon.load(depth, 1.0, poisson_ratio, BERKOVICH_CONE)
    if radius is not None:
        unit = hertz.load(depth, 1.0, poisson_ratio, radius)
    return float(recording.load[peak] / unit)


def ranges(law: str, solid: Solid, shortest: float) -> dict[str, tuple[float, ...]]:
    """Return guessed ranges of a law's parameters; one value holds a parameter constant.

    A solid that creeps is stiffer than an elastic one as deep, and its unloadings tell no modulus, as creep goes on in
    them. One that yields unloads elastically, but a frame left in the depth flattens that. The yield stress lies
    between a fifth and nine tenths of the hardness (Johnson, Contact Mechanics, 1985, section 6.3). Creep is that of an
    epoxy whose stresses grow with the modulus, from none to about three times as much; what recovers does so in a time
    between a five-hundredth and four tenths of the shortest loading.

    Parameters
    ----------
    shortest
        Shortest time of loading among the tests [s].

    Raises
    ------
    InputError
        When the law yields and no unloading tells a modulus.
    """
    names = [parameter.name for parameter in LAWS[law].declared({})]
    middle, low, high = 1.5 * solid.secant, 0.8 * solid.secant, 3.0 * solid.secant
    if "yield_stress" in names:
        if math.isnan(solid.modulus):
            raise InputError(
                f"no unloading tells a modulus, which the ranges of {law} are guessed from",
                remedy="use --law nonlinear_burgers, or write the study by hand",
            )
        middle, low, high = solid.modulus, 0.4 * solid.modulus, 1.8 * solid.modulus
    stress = middle / EPOXY_MODULUS
    known: dict[str, tuple[float, ...]] = {
        "youngs_modulus": (low, high),
        "yield_stress": (0.2 * solid.hardness, 0.9 * solid.hardness),
        "hardening": (0.0, 0.1 * middle),
        "steady_coefficient": (0.0, 0.2 * stress**-1.5),
        "steady_exponent": (0.1, 0.8),
        "transient_coefficient": (0.0, 0.6 * stress**-1.6),
        "transient_exponent": (0.1, 0.8),
        "retardation_time": (0.002 * shortest, 0.4 * shortest),
    }
    if law == "burgers_plasticity":
        known |= {"steady_coefficient": (0.0,), "steady_exponent": (0.0,), "transient_exponent": (0.0,)}
        known |= {"transient_coefficient": (0.0, 0.3 / middle), "retardation_time": (0.5 * shortest,)}
    return {name: known[name] for name in names if name in known}


def study_text(
    name: str,
    groups: Sequence[Group],
    folder: Path,
    law: str,
    solid: Solid,
    radius: float | None = None,
    stated: Stated = NOTHING,
) -> str:
    """Return the YAML of a study.

    Parameters
    ----------
    groups
        Of `palpate.grouping.grouped`. Of three or more that in the middle judges, the others calibrate.
    folder
        Where the recordings lie.
    radius
        Of a spherical tip [nm]; when not given, the tip of the files' area function, or a Berkovich tip's equivalent
        cone where they state none.
    stated
        What the files say of tip and sample.
    """
    units = {parameter.name: parameter.unit for parameter in LAWS[law].declared({})}
    shortest = min(float(group.recordings[0].time[np.argmax(group.recordings[0].load)]) for group in groups)
    parameters = []
    for key, values in ranges(law, solid, shortest).items():
        shown = ", ".join(f"{value:.3g}" for value in values)
        parameters.append(_row(f"  {key}: [{shown}]", units[key] if len(values) > 1 else f"{units[key]}, constant"))
    judge = groups[len(groups) // 2] if len(groups) > 2 else None
    conditions = []
    for group in groups:
        role, count = "validate" if group is judge else "calibrate", len(group.recordings)
        entry = f"  - {{name: {group.name}, {_keys(group.history)}, role: {role}}}"
        conditions.append(_row(entry, f"{count} test{'s' if count > 1 else ''}"))
    return STUDY.substitute(
        name=name,
        material=_row(
            f"material: {{model: {law}, poisson_ratio: {stated.poisson_ratio or POISSON_RATIO:g}}}",
            "as the files state" if stated.poisson_ratio else "guess",
        ),
        reason=f"ranges about a modulus of {solid.modulus:.3g} and a hardness of {solid.hardness:.3g} GPa, by unloading"
        if "yield_stress" in units
        else f"an elastic body as deep has a modulus of {solid.secant:.3g} GPa; creep asks for more",
        parameters="\n".join(parameters),
        points=POINTS,
        indenter=_indenter(radius, stated.area),
        conditions="\n".join(conditions),
        recordings=folder.as_posix(),
        diagnosis=_row("diagnosis: {enabled: false}", "take this line out to ask what is missing from the model"),
    )


def study_name(folder: Path) -> str:
    """Return a name for a study after a folder."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", folder.resolve().name).lstrip("._-") or "study"


def _indenter(radius: float | None, area: Sequence[float]) -> str:
    if radius is not None:
        return _row(f"indenter: {{shape: sphere, radius: {radius:g}}}", "nm")
    if area:
        coefficients = ", ".join(f"{value:.9g}" for value in area)
        return _row(f"indenter: {{shape: area_function, area: [{coefficients}]}}", "nm, as the files state")
    cone = f"indenter: {{shape: cone, half_angle: {BERKOVICH_CONE}}}"
    return _row(cone, "guess: a Berkovich tip, by its equivalent cone")


def _row(text: str, comment: str) -> str:
    return f"{text:<60}  # {comment}"


def _keys(history: Mapping[str, float | str]) -> str:
    return ", ".join(f"{key}: {value if isinstance(value, str) else f'{value:g}'}" for key, value in history.items())
