"""The YAML of a drafted study."""

from __future__ import annotations

import os
import re
import sys
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Template

import yaml

from palpate.configuration.study_file import SHARED
from palpate.draft.grouping import FOR_VALIDATION, Group
from palpate.draft.guess_table import Guess
from palpate.draft.guesses import points_for
from palpate.draft.known_tip import KnownTip
from palpate.materials import law_of
from palpate.materials.first_guess import Guessed

LEFT_OPEN = (
    "# results/NAME/law.json will hold the law that is chosen, and ranges of its parameters;",
    "# palpate draft --law states one instead, such as burgers_plasticity: see docs/laws.md",
)
WIDTH = 116  # of a comment, without its sign
STUDY = Template("""\
# A first study, drafted from recordings. Correct what is marked `guess` where you know better.
# docs/study.md lists every key.
${remarks}study: $name
seed: 1                # of all random numbers
cells_per_job: 64      # materials that one job simulates

# law: $why
$material
$parameters

# drive, which is what the instrument prescribes: $drive
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
    tip: KnownTip,
    guessed: Mapping[str, Guessed],
    table: Sequence[Guess],
    remarks: Sequence[str],
) -> str:
    """Return the YAML of a study.

    Parameters
    ----------
    name
        Name of the study.
    groups
        Of `palpate.draft.grouping.grouped`. Of three or more that in the middle validates, the others calibrate.
    folder
        Where the recordings lie.
    tip
        Its keys, and where they are known from.
    guessed
        Ranges of the law's parameters.
    table
        What was taken or guessed, and why, see `palpate.draft.guess_table`.
    remarks
        Remarks on the draft, a comment each.
    """
    rows = {row.what: row for row in table}
    law, ratio = rows["law"].value, rows["Poisson's ratio"]
    return STUDY.substitute(
        remarks="".join(_comment(remark) for remark in remarks),
        name=scalar(name),
        why=rows["law"].why,
        material=_row(f"material: {{model: {law}, poisson_ratio: {ratio.value}}}", ratio.why),
        parameters="\n".join(_parameters(law, guessed, rows) if guessed else LEFT_OPEN),
        drive=rows["drive"].why,
        indenter=_row(f"indenter: {{{_keys(tip.keys)}}}", tip.why),
        conditions="\n".join(_conditions(groups)),
        recordings=scalar(folder.as_posix()),
        diagnosis=_row(
            "diagnosis: {enabled: true}", "searches for missing effects; mechanisms: [...] restricts it, false skips it"
        ),
    )


def study_name(folder: Path) -> str:
    """Return a name for a study after a folder, other than those of folders of results."""
    name = re.sub(r"[^A-Za-z0-9._-]+", "_", os.path.basename(os.path.realpath(folder))).lstrip("._-") or "study"
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


def _parameters(law: str, guessed: Mapping[str, Guessed], rows: Mapping[str, Guess]) -> Iterator[str]:
    """Yield one line a parameter, its range, its unit, and the reason; and the number of materials in these ranges."""
    yield "# ranges of plausible values; an estimate may lie outside, and the report then says so"
    yield "parameters:"
    units = {parameter.name: parameter.unit for parameter in law_of(law).declared({})}
    for key, (values, _) in guessed.items():
        shown = ", ".join(f"{value:.4g}" for value in values)
        unit = units[key] if len(values) > 1 else f"{units[key]}, constant"
        yield _row(f"  {key}: [{shown}]", f"{unit}; {rows[key].why}")
    yield f"design: {{kind: sobol, points: {points_for(guessed)}}}"


def _conditions(groups: Sequence[Group]) -> Iterator[str]:
    """Yield one line a condition; of three or more that in the middle validates."""
    held_out = groups[len(groups) // 2] if len(groups) >= FOR_VALIDATION else None
    for group in groups:
        role, count = "validate" if group is held_out else "calibrate", len(group.recordings)
        entry = f"  - {{name: {group.name}, {_keys(group.history)}, role: {role}}}"
        own = ", each under a load of its own" if "own_loads" in group.history else ""
        parts = f", {group.held_out} held out" if group.held_out else ""
        yield _row(entry, f"{count} test{'s' if count > 1 else ''}{own}{parts}")


def _comment(text: str) -> str:
    lines = textwrap.wrap(text, WIDTH, break_long_words=False, break_on_hyphens=False)
    return "# " + "\n#   ".join(lines) + "\n"


def _row(text: str, comment: str) -> str:
    return f"{text:<60}  # {comment}"


def _keys(keys: Mapping[str, object]) -> str:
    return ", ".join(f"{key}: {_value(value)}" for key, value in keys.items())


def _value(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return value if isinstance(value, str) else f"{value:.9g}"
