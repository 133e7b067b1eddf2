"""Elasticity at small strains in CalculiX, without and with friction, on two meshes."""

from __future__ import annotations

from pathlib import Path

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.verification.calculix import (
    RULE,
    Comparison,
    compared,
    refinement_error,
    run_deck,
    with_and_without_friction,
)
from palpate.verification.case import Plot, Row
from palpate.verification.reference_materials import HOOKE

ELASTIC = Comparison("elastic", "elastic", HOOKE, 1.0, 1.0)


def compare(program: Path, friction: float) -> tuple[list[Row], Plot]:
    """Compare elasticity under a cone with this friction."""
    test = ELASTIC.specification(20, friction=friction)
    coarse, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
    return compared(ELASTIC.name, test, fine, refinement_error(test, fine, coarse))


CASE = with_and_without_friction("calculix_elastic", "CalculiX: elasticity", compare, [RULE])
