"""The YAML of a drafted study."""

from __future__ import annotations

import re
import sys
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template

import numpy as np
import yaml

from palpate.configuration.study_file import SHARED
from palpate.draft.grouping import Group
from palpate.draft.guesses import ranges
from palpate.draft.solid import BERKOVICH_CONE, NOTHING, POISSON_RATIO, Solid
from palpate.draft.stated import Stated
from palpate.materials import law_of

POINTS = 128
WIDTH = 116  # of a comment, without its sign
STUDY = Template("""\
# A first study, drafted from recordings. Load histories and replicates are theirs; what says `guess` is not.
# docs/study.md tells every key.
${remarks}study: $name
seed: 1
cells_per_job: 64

$material
# guess: $reason;
# a range is what is plausible and no wall: estimates may lie outside, and the report says which do
parameters:
$parameters
design: {kind: sobol, points: $points}

$indenter

conditions:
$conditions

recordings: {lab: $recordings}

$diagnosis
""")


def study_text(
    name: str,
    groups: Sequence[Group],
    folder: Path,
    law: str,
    solid: Solid,
    radius: float | None = None,
    stated: Stated = NOTHING,
    remarks: Sequence[str] = (),
) -> str:
    """Return the YAML of a study.

    Parameters
    ----------
    name
        Name of the study.
    law
        Key of the constitutive law.
    solid
        Modulus and hardness from which the ranges of the parameters follow.
    groups
        Of `palpate.draft.grouping.grouped`. Of three or more that in the middle judges, the others calibrate.
    folder
        Where the recordings lie.
    radius
        Of a spherical tip [nm]; when not given, the tip of the files' area function, or a Berkovich tip's equivalent
        cone where they state none.
    stated
        What the files say of tip and sample.
    remarks
        What people should know of the draft, a comment each.
    """
    units = {parameter.name: parameter.unit for parameter in law_of(law).declared({})}
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
        remarks="".join(_comment(remark) for remark in remarks),
        name=scalar(name),
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
        recordings=scalar(folder.as_posix()),
        diagnosis=_row("diagnosis: {enabled: false}", "take this line out to ask what is missing from the model"),
    )


def study_name(folder: Path) -> str:
    """Return a name for a study after a folder, other than those of folders of results."""
    name = re.sub(r"[^A-Za-z0-9._-]+", "_", folder.resolve().name).lstrip("._-") or "study"
    return f"{name}_study" if name in SHARED else name


def scalar(text: str) -> str:
    """Return a text as YAML reads it back inside braces too, in quotes where it needs them."""
    try:
        float(text)  # such as 1e5, which the YAML of palpate takes for a number and PyYAML for a word
        style = '"'
    except ValueError:
        style = None
    listed = yaml.safe_dump([text], default_style=style, default_flow_style=True, allow_unicode=True, width=sys.maxsize)
    return str(listed).strip()[1:-1]


def printable(text: str) -> str:
    """Return a text with all that is no letter or sign, such as bytes of a file's name, written as a number."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _comment(text: str) -> str:
    lines = textwrap.wrap(text, WIDTH, break_long_words=False, break_on_hyphens=False)
    return "# " + "\n#   ".join(lines) + "\n"


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
