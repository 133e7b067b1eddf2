"""The section ``evidence`` of a study: what was measured of the material besides indentation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.configuration.schema import suggestion
from palpate.errors import InputError, part_of

NONE = "none"  # of a test that belongs to no condition
AUTO = "auto"  # the quantity that the file shows to be prescribed


@dataclass(frozen=True)
class EvidenceFile:
    """One file of further evidence.

    Parameters
    ----------
    kind
        What it holds: ``uniaxial``, a test of the bulk.
    file
        Such as ``tension.csv``.
    role
        ``calibrate``: it is fitted; ``validate``: it only judges the law that was calibrated.
    control
        Which quantity was prescribed, ``strain`` or ``stress``; `AUTO`.
    """

    kind: str
    file: Path
    role: str
    control: str = AUTO

    @property
    def name(self) -> str:
        """By which results call it."""
        return self.file.stem


def evidence_from(given: Sequence[Mapping[str, Any]], conditions: Sequence[str]) -> tuple[EvidenceFile, ...]:
    """Return the entries of a section ``evidence``.

    Parameters
    ----------
    given
        The entries, which keep to the schema.
    conditions
        Names of the study's conditions.

    Raises
    ------
    InputError
        When an entry belongs to a condition, or two files have one name.
    """
    found: list[EvidenceFile] = []
    for k, entry in enumerate(given):
        file, of = Path(entry["file"]).expanduser(), entry.get("of") or NONE
        with part_of(f"evidence[{k}]"):
            if of != NONE:
                known = of in conditions
                raise InputError(
                    f"a uniaxial test belongs to no condition, {of!r} is given"
                    if known
                    else f"{of!r} is no condition of the study{suggestion(of, conditions)}",
                    remedy="write of: none, or leave it out",
                    place="of",
                )
            if file.stem in [each.name for each in found]:
                remedy = "rename one of them: results are listed by the name of the file"
                raise InputError(f"another file of evidence is called {file.stem}, too", remedy=remedy, place="file")
        found.append(EvidenceFile(entry["kind"], file, entry.get("role", "calibrate"), entry.get("control", AUTO)))
    return tuple(found)
