"""Convergence of the solver in mesh, time step and far boundary, with observed orders and extrapolated values.

Three solutions f1, f2, f3 at sizes that halve have the observed order p = log2((f1 - f2)/(f2 - f3)) and the
extrapolated value f3 + (f3 - f2)/(2^p - 1).

Source: P. J. Roache, Annu. Rev. Fluid Mech. 29 (1997) 123-160, generalized Richardson extrapolation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from palpate.materials import LAWS
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.axisymmetric.indentation_case import Case as Indentation
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.study.protocol import trapezoid
from palpate.study.specimen import Specimen
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification
from studies.verification.reference_materials import BURGERS, CONE

STANDARD_WITHIN = 0.005  # of the depth
ORDER_WITHIN = 0.2  # of the order
PROTOCOL = trapezoid(1.0, 30.0, 0.0, 30.0, points=50)
LOADED = PROTOCOL.sample_load >= 0.15


def mean_depths(resolutions: Sequence[Resolution]) -> list[float]:
    """Return the mean depth [nm] of the epoxy's curve from 15 % of the load on: one number a resolution."""
    epoxy = Specimen(LAWS["nonlinear_burgers"].coefficients(BURGERS))
    histories = indent_batch([Indentation(epoxy, CONE, PROTOCOL, resolution) for resolution in resolutions])
    return [float(history.depth[LOADED].mean()) for history in histories]


def richardson(values: Sequence[float]) -> tuple[float, float]:
    """Return observed order and extrapolated value from the last three of `values`, whose sizes halve.

    The order is NaN when the differences change sign or do not shrink; the last value is then all that is known.
    """
    first, second, third = values[-3:]
    ratio = (first - second) / (second - third) if second != third else np.nan
    if not ratio > 1:
        return float("nan"), float(third)
    return float(np.log2(ratio)), float(third + (third - second) / (ratio - 1))


def run(settings: Settings) -> Outcome:
    """Refine mesh, time step and far boundary, one at a time, about the standard resolution."""
    standard = RESOLUTIONS["standard"]
    studies = {
        "mesh": [replace(standard, growth=1 + 0.1 * part, sectors=int(8 / part)) for part in (2, 1, 0.5)],
        "time step": [replace(standard, refine=parts) for parts in (2, 4, 8)],
        "far boundary": [replace(standard, far=far) for far in (250.0, 500.0, 1000.0, 2000.0)],
    }
    orders = {"mesh": None, "time step": 2.0, "far boundary": 1.0}
    (whole, fine), rows, series = mean_depths([standard, RESOLUTIONS["fine"]]), [], []
    for name, resolutions in studies.items():
        values = mean_depths(resolutions)
        order, limit = richardson(values)
        rows.append(Row(f"{name}: mean depth, standard against extrapolated [nm]", limit, whole, STANDARD_WITHIN))
        expected, quantity = orders[name], f"{name}: observed order"
        if expected is None:
            note = "not a check: no order is known where the contact edge moves node by node"
            rows.append(Row(quantity, float("nan"), order, None, note))
        else:
            rows.append(Row(quantity, expected, order, ORDER_WITHIN))
        error = np.abs(np.array(values) / limit - 1)
        sizes = 0.5 ** np.arange(len(values))
        series.append(PlottedSeries(f"{name} (order {order:.2f})", sizes, 100 * error))
    rows.append(Row("mean depth, standard against fine [nm]", fine, whole, STANDARD_WITHIN))
    plot = Plot("convergence", "size, relative to the coarsest", "deviation from extrapolated [%]", series, (), True)
    note = "The epoxy's test: nonlinear Burgers, 1 mN, 30 s up, 30 s down; mean depth from 15 % of the load on."
    return Outcome(rows, [plot], [note])


CASES = (Verification("convergence", "Convergence of the solver", run),)
