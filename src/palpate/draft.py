"""A first study of recordings: what they say is written down, what they do not say is guessed and marked as such."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np

from palpate.classical import AreaFunction, oliver_pharr
from palpate.errors import InputError
from palpate.grouping import Group
from palpate.materials import LAWS
from palpate.recording import Recording

POISSON_RATIO = 0.35
BERKOVICH_CONE = 70.3
EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml
POINTS = 256
STUDY = Template("""\
# A first study, drafted from recordings. Load histories and replicates are theirs; what says `guess` is not.
# docs/study.md tells every key.
study: $name
seed: 1

$material
# guess: ranges about a modulus of $modulus and a hardness of $hardness GPa, by Oliver and Pharr from the unloadings;
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
class Hardness:
    """What unloading tells of a solid without any model: modulus and hardness [GPa], medians of the tests.

    Source: W.C. Oliver and G.M. Pharr, J. Mater. Res. 7 (1992) 1564-1583.
    """

    modulus: float
    hardness: float

    @classmethod
    def of(cls, recordings: Sequence[Recording], radius: float | None) -> Hardness:
        """Analyse recordings under a Berkovich tip, or a sphere of a `radius` [nm].

        Raises
        ------
        InputError
            When no unloading can be analysed; says what is wrong with the first.
        """
        area = None if radius is None else AreaFunction((-np.pi, 2.0 * np.pi * radius))
        found, errors = [], []
        for recording in recordings:
            try:
                found.append(oliver_pharr(recording.load, recording.depth, POISSON_RATIO, area=area))
            except InputError as error:
                errors.append(error.located(place=recording.name))
        if not found:
            raise errors[0]
        return cls(float(np.median([f.modulus for f in found])), float(np.median([f.hardness for f in found])))


def ranges(law: str, solid: Hardness, shortest: float) -> dict[str, tuple[float, ...]]:
    """Return guessed ranges of a law's parameters; one value holds a parameter constant.

    Solids that creep unload too steeply for their modulus, and a frame left in the depth flattens unloading: the
    modulus is looked for from 0.4 to 1.8 times what unloading says. The yield stress lies between a fifth and nine
    tenths of the hardness (Johnson, Contact Mechanics, 1985, section 6.3). Creep is that of an epoxy whose stresses
    grow with the modulus, from none to about three times as much.

    Parameters
    ----------
    shortest
        Shortest time of loading among the tests [s].
    """
    stress = solid.modulus / EPOXY_MODULUS
    known: dict[str, tuple[float, ...]] = {
        "youngs_modulus": (0.4 * solid.modulus, 1.8 * solid.modulus),
        "yield_stress": (0.2 * solid.hardness, 0.9 * solid.hardness),
        "hardening": (0.0, 0.1 * solid.modulus),
        "steady_coefficient": (0.0, 0.2 * stress**-1.5),
        "steady_exponent": (0.1, 0.8),
        "transient_coefficient": (0.0, 0.6 * stress**-1.6),
        "transient_exponent": (0.1, 0.7),
        "retardation_time": (0.1 * shortest,),
    }
    if law == "burgers_plasticity":
        known |= {"steady_coefficient": (0.0,), "steady_exponent": (0.0,), "transient_exponent": (0.0,)}
        known |= {"transient_coefficient": (0.0, 0.3 / solid.modulus), "retardation_time": (0.5 * shortest,)}
    names = [parameter.name for parameter in LAWS[law].declared({})]
    return {name: known[name] for name in names if name in known}


def study_text(
    name: str,
    groups: Sequence[Group],
    folder: Path,
    law: str,
    solid: Hardness,
    radius: float | None = None,
) -> str:
    """Return the YAML of a study.

    Parameters
    ----------
    groups
        Of `palpate.grouping.grouped`. Of three or more that in the middle judges, the others calibrate.
    folder
        Where the recordings lie.
    radius
        Of a spherical tip [nm]; a Berkovich tip's equivalent cone when not given.
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
    cone = f"indenter: {{shape: cone, half_angle: {BERKOVICH_CONE}}}"
    return STUDY.substitute(
        name=name,
        material=_row(f"material: {{model: {law}, poisson_ratio: {POISSON_RATIO}}}", "guess"),
        modulus=f"{solid.modulus:.3g}",
        hardness=f"{solid.hardness:.3g}",
        parameters="\n".join(parameters),
        points=POINTS,
        indenter=_row(cone, "guess: a Berkovich tip, by its equivalent cone")
        if radius is None
        else _row(f"indenter: {{shape: sphere, radius: {radius:g}}}", "nm"),
        conditions="\n".join(conditions),
        recordings=folder.as_posix(),
        diagnosis=_row("diagnosis: {enabled: false}", "take this line out to ask what is missing from the model"),
    )


def study_name(folder: Path) -> str:
    """Return a name for a study after a folder."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", folder.resolve().name).lstrip("._-") or "study"


def _row(text: str, comment: str) -> str:
    return f"{text:<60}  # {comment}"


def _keys(history: Mapping[str, float | str]) -> str:
    return ", ".join(f"{key}: {value if isinstance(value, str) else f'{value:g}'}" for key, value in history.items())
