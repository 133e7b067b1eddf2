"""Elasticity at small strains in CalculiX, without and with friction, on two meshes."""

from __future__ import annotations

from palpate.output.export.quadratic import RESOLUTIONS
from palpate.verification.calculix import FRICTION, NOT_RUN, RULE, Comparison, compared, refinement_error, run_deck
from palpate.verification.case import Outcome, Settings, Verification
from palpate.verification.reference_materials import HOOKE

ELASTIC = Comparison("elastic", "elastic", HOOKE, 1.0, 1.0)


def run(settings: Settings) -> Outcome:
    """Compare both, or say why there is nothing to compare."""
    program = settings.calculix
    if program is None:
        return Outcome([], notes=[NOT_RUN])
    rows, plots = [], []
    for friction in (0.0, FRICTION):
        test = ELASTIC.specification(20, friction=friction)
        coarse, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
        found, plot = compared(ELASTIC.titled(friction), test, fine, refinement_error(test, fine, coarse))
        rows += found
        plots.append(plot)
    return Outcome(rows, plots, [RULE])


CASE = Verification("calculix_elastic", "CalculiX: elasticity", run)
