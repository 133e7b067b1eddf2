"""Aluminium at small strains in CalculiX, without and with friction, on two meshes and in two steps of the load.

The direction of plastic flow is that at the end of a step, and the contact that spreads turns it meanwhile.
"""

from __future__ import annotations

from palpate.export.quadratic import RESOLUTIONS
from palpate.verification.calculix import FRICTION, NOT_RUN, RULE, STEPS, Comparison, compared, refined, run_deck
from palpate.verification.case import Case, Outcome, Settings
from palpate.verification.materials import ALUMINIUM

PLASTIC = Comparison("aluminium, small strains", "bilinear_plasticity", ALUMINIUM, 4.9, 15.0)
POINTS = 40


def run(settings: Settings) -> Outcome:
    """Compare both, or say why there is nothing to compare."""
    program = settings.calculix
    if program is None:
        return Outcome([], notes=[NOT_RUN])
    rows, plots = [], []
    for friction in (0.0, FRICTION):
        test, halved = (PLASTIC.specification(points, friction=friction) for points in (POINTS, 2 * POINTS))
        long, fine = (run_deck(program, test, RESOLUTIONS[mesh]) for mesh in ("standard", "fine"))
        short = run_deck(program, halved, RESOLUTIONS["standard"])[1::2]
        theirs, own_error = refined(test, long, short, fine)
        found, plot = compared(PLASTIC.titled(friction), test, theirs, own_error)
        rows += found
        plots.append(plot)
    return Outcome(rows, plots, [RULE, STEPS])


CASE = Case("calculix_plastic", "CalculiX: aluminium at small strains", run)
