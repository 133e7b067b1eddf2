"""The section ``evidence`` of a study: what was measured of the material besides indentation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate.configuration.checked_file import suggestion
from palpate.configuration.entries import EvidenceEntry
from palpate.errors import InputError, part_of

NONE = "none"  # of a test that belongs to no condition
UNIAXIAL, IMPRINT = "uniaxial", "imprint"
AUTO = "auto"  # the quantity that the file shows to be prescribed


@dataclass(frozen=True)
class EvidenceFile:
    """One file of further evidence.

    Parameters
    ----------
    kind
        What it holds: `UNIAXIAL`, a test of the bulk, or `IMPRINT`, the residual profile of a test.
    file
        Such as ``tension.csv``.
    role
        ``calibrate``: it is fitted; ``validate``: it only judges the law that was calibrated.
    control
        Which quantity was prescribed in a uniaxial test, ``strain`` or ``stress``; `AUTO`.
    of
        The condition that made an imprint; `NONE` of a uniaxial test.
    """

    kind: str
    file: Path
    role: str
    control: str = AUTO
    of: str = NONE

    @property
    def name(self) -> str:
        """By which results call it."""
        return self.file.stem


def evidence_from(given: Sequence[EvidenceEntry], conditions: Sequence[str]) -> tuple[EvidenceFile, ...]:
    """Return the entries of a section ``evidence``.

    Parameters
    ----------
    given
        The entries.
    conditions
        Names of the study's conditions.

    Raises
    ------
    InputError
        When a uniaxial test belongs to a condition or an imprint to none, an imprint is to calibrate, or two files have
        one name.
    """
    found: list[EvidenceFile] = []
    for k, entry in enumerate(given):
        file, of = Path(entry.file).expanduser(), entry.of or NONE
        with part_of(f"evidence[{k}]"):
            _check_owner(entry, of, conditions)
            if file.stem in [each.name for each in found]:
                remedy = "rename one of them: results are listed by the name of the file"
                raise InputError(f"another file of evidence is called {file.stem}, too", remedy=remedy, place="file")
        found.append(EvidenceFile(entry.kind, file, entry.role, entry.control, of))
    return tuple(found)


def _check_owner(entry: EvidenceEntry, of: str, conditions: Sequence[str]) -> None:
    """Refuse a condition that does not belong to evidence, or is missing, and an imprint that calibrates."""
    imprint = entry.kind == IMPRINT
    if of != NONE and of not in conditions:
        remedy = f"use one of: {', '.join(conditions)}" if imprint else "write of: none, or leave it out"
        problem = f"{of!r} is no condition of the study{suggestion(of, conditions)}"
        raise InputError(problem, remedy=remedy, place="of")
    if of != NONE and not imprint:
        problem = f"a uniaxial test belongs to no condition, {of!r} is given"
        raise InputError(problem, remedy="write of: none, or leave it out", place="of")
    if imprint and of == NONE:
        remedy = f"name its condition: {', '.join(conditions)}"
        raise InputError("an imprint without the test that made it says nothing", remedy=remedy, place="of")
    if imprint and entry.role == "calibrate":
        raise InputError(
            "an imprint judges the law, it cannot calibrate it yet", remedy="write role: validate", place="role"
        )
    if imprint and entry.control != AUTO:
        raise InputError("nothing is prescribed of an imprint", remedy="leave it out", place="control")
