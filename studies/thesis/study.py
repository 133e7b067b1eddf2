"""What a study of the thesis is: the curves it needs, the tables it makes, and a verdict beside the thesis' number."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from palpate.configuration.study_file import Study
from palpate.errors import InputError
from studies.thesis.fitted import Fitted
from studies.thesis.rules import Rule
from studies.thesis.runs import Curves

VERDICTS = ("reproduced", "differs", "not in the thesis", "not run")
Rows = list[dict[str, Any]]


@dataclass(frozen=True)
class Finding:
    """One claim of the thesis beside what came out here.

    Parameters
    ----------
    what
        What is compared.
    thesis, here
        The thesis' number or pattern, and ours.
    verdict
        One of `VERDICTS`.
    why
        What to bear in mind; where it differs, the reason.
    rule
        What had to hold for ``reproduced``.

    Raises
    ------
    InputError
        On an unknown verdict, one of the first two without a rule, or a difference without a reason.
    """

    what: str
    thesis: str
    here: str
    verdict: str
    why: str = ""
    rule: str = ""

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise InputError(f"verdict is {self.verdict!r}", remedy=f"use one of: {', '.join(VERDICTS)}")
        if self.verdict in VERDICTS[:2] and not self.rule:
            raise InputError(f"the verdict on {self.what!r} rests on no rule", remedy="say what had to hold")
        if self.verdict == "differs" and not self.why:
            raise InputError(f"{self.what!r} differs without a reason", remedy="say why")


def compare(what: str, thesis: str, here: str, rule: Rule, why: str) -> Finding:
    """Return a finding that is reproduced if the rule holds, and differs otherwise."""
    return Finding(what, thesis, here, "reproduced" if rule.holds else "differs", why, rule.statement)


@dataclass(frozen=True)
class Outcome:
    """What a study found, ready for JSON.

    Parameters
    ----------
    tables
        Rows of each table by its title.
    findings
        Claims and verdicts.
    series
        What the figure draws, beside the tables.
    fitted
        Surrogates and fits for MLflow; they do not go into the JSON.
    """

    tables: Mapping[str, Rows]
    findings: Sequence[Finding]
    series: Mapping[str, Any] = field(default_factory=dict)
    fitted: Sequence[Fitted] = ()

    def to_mapping(self) -> dict[str, Any]:
        """Return the outcome for the json module."""
        findings = [asdict(finding) for finding in self.findings]
        return {"tables": dict(self.tables), "findings": findings, "series": dict(self.series)}


@dataclass(frozen=True, eq=False)
class Context:
    """What a study may use.

    Parameters
    ----------
    studies
        Checked configuration of each material: ``aluminium`` and ``epoxy``.
    curves
        Curves of every design that the study asked for.
    """

    studies: Mapping[str, Study]
    curves: Mapping[str, Curves]


@dataclass(frozen=True, eq=False)
class ThesisStudy:
    """A study of the thesis.

    Parameters
    ----------
    key
        Name of its files.
    title
        For people.
    run
        From context to outcome.
    designs
        Designs whose curves it needs.
    recordings
        Materials whose synthetic recordings it needs.
    libraries
        Of the extra ``studies``, that it needs.
    """

    key: str
    title: str
    run: Callable[[Context], Outcome]
    designs: Sequence[str] = ()
    recordings: Sequence[str] = ()
    libraries: Sequence[str] = ()
