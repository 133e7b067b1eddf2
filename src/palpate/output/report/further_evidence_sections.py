"""The sections of the report on what was measured besides indentation curves: uniaxial tests, and imprints."""

from __future__ import annotations

from collections.abc import Callable

from palpate.output.html_report import paragraph, table
from palpate.output.results.answer import Answer
from palpate.output.results.bulk_errors import bulk_table
from palpate.output.results.imprint_errors import imprint_table


def uniaxial(found: Answer, picture: Callable[[str], str]) -> list[str]:
    """Return figure and errors of the uniaxial tests; nothing where a study has none."""
    tests = found.calibration.uniaxial
    if not tests:
        return []
    about = (
        "The law at a material point under what the machine prescribed, without finite elements. The band is that of "
        "the base model's parameters; in band: share of the points in it, with twice the noise."
    )
    return [picture("uniaxial"), paragraph(about), table(bulk_table(tests))]


def imprint(found: Answer, picture: Callable[[str], str]) -> list[str]:
    """Return figure and errors of the imprints; nothing where a study has none."""
    profiles = found.calibration.imprint
    if not profiles:
        return []
    about = "The surface of the finite elements at the end of the test, with the base model's law."
    return [picture("imprint"), paragraph(about), table(imprint_table(profiles))]
