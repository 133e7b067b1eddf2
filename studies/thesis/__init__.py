"""The studies of the thesis, one a file: which curves each needs, and the tables it makes of them.

A module that defines ``STUDY`` is a study; one that defines ``DESIGNS`` names sets of curves that studies share.
"""

from __future__ import annotations

from indentation_files.discovery import discover
from studies.thesis.runs import Curves, Design, compute
from studies.thesis.study import Context, Finding, Outcome, ThesisStudy

STUDIES: dict[str, ThesisStudy] = {study.key: study for study in discover(__name__, __path__, "STUDY")}
DESIGNS: dict[str, Design] = {
    name: design for shared in discover(__name__, __path__, "DESIGNS") for name, design in shared.items()
}

__all__ = ["DESIGNS", "STUDIES", "Context", "Curves", "Design", "Finding", "Outcome", "ThesisStudy", "compute"]
