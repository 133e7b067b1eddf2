r"""Eyring flow: creep of thermally activated segments, which pressure slows.

$$\dot\varepsilon = \frac{3}{2} \frac{s}{\sigma_e} r_0 \sinh\left(\frac{\sigma_e}{\sigma_0}\right)
\exp\left(-\frac{\mu p}{\sigma_0}\right), \qquad \sigma_e = \sqrt{3 J_2}$$

$r_0$ is a rate, $\sigma_0$ is $kT$ over the activation volume, and $p$ the pressure, positive in compression.

Source: H. Eyring, J. Chem. Phys. 4 (1936) 283-291; I.M. Ward, J. Mater. Sci. 6 (1971) 1397-1417, for the pressure.
"""

from __future__ import annotations

import math

from palpate.base.parameters import Parameter
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, exponential, where_less
from palpate.materials.flow.registry import fluidity
from palpate.materials.law import Creep, Law

FLOW = (
    Parameter("reference_rate", "r_0", "1/s", 0.0, 1e6, "strain rate at a stress of about sigma_0"),
    Parameter("eyring_stress", r"\sigma_0", "GPa", 1e-12, 1e3, "stress that raises the strain rate e-fold"),
    Parameter("pressure_coefficient", r"\mu", "-", 0.0, 1.0, "stress that balances a unit of pressure"),
)
ROOT3 = math.sqrt(3.0)
STEEPEST = 200.0  # of the exponent of a rate: above it its slope counts as none; far above what any solution reaches
TENSION, COMPRESSION = -100.0, 500.0  # bounds of mu p / sigma_0
SMALL = 0.5  # z, below which sinh(z) / z is a series


@fluidity
def sinh_of_stress(law, at, q, log_q, pressure, alpha, gain):
    """Return (sqrt(3)/2) r_0 sinh(z) exp(-mu p / sigma_0) / q with z = sqrt(3) q / sigma_0, and its derivatives.

    Arguments and result are those of `palpate.materials.flow.registry.fluidity`.
    """
    rate, sigma_0, mu = entry(law, at), entry(law, at + 1), entry(law, at + 2)
    inverse = 1.0 / sigma_0
    none, small, steepest = constant(q, 0.0), constant(q, SMALL), constant(q, STEEPEST)
    least, most = constant(q, TENSION), constant(q, COMPRESSION)
    z, barrier = ROOT3 * q * inverse, mu * pressure * inverse
    barrier = where_less(barrier, least, least, where_less(barrier, most, barrier, most))
    impeded, exponent = exponential(none - barrier), z - barrier
    beyond = exponent - steepest
    rising = exponential(where_less(none, beyond, steepest, exponent))
    falling = impeded * impeded / rising
    square, sinh, cosh = z * z, 0.5 * (rising - falling), 0.5 * (rising + falling)
    series = 1.0 + square * (1 / 6) * (1.0 + square * (1 / 20) * (1.0 + square * (1 / 42) * (1.0 + square * (1 / 72))))
    bend = square * (1 / 3) * (1.0 + square * (1 / 10) * (1.0 + square * (1 / 28) * (1.0 + square * (1 / 54))))
    ratio = where_less(z, small, impeded * series, sinh / z)
    slope = where_less(z, small, impeded * bend, cosh - ratio)
    slope = where_less(none, beyond, none, slope)
    curve = where_less(none, beyond, none, z * sinh - cosh + ratio)
    scale = 1.5 * rate * inverse
    value = scale * ratio
    return value, scale * slope, scale * curve, none - mu * inverse * value


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of rate, stress and pressure's share."""
    return {
        "reference_rate": Guessed((1e-8, 1e-4), USUAL),
        "eyring_stress": Guessed((0.02 * glimpse.hardness, 0.1 * glimpse.hardness), "2 to 10 % of the hardness"),
        "pressure_coefficient": Guessed((0.0, 0.3), USUAL),
    }


LAW = Law(
    "eyring",
    "Eyring flow",
    FLOW,
    lambda values: [Creep(sinh_of_stress, [values[p.name] for p in FLOW], pressed=True)],
    example={"reference_rate": 1e-8, "eyring_stress": 0.004, "pressure_coefficient": 0.1},
    guess=guess,
)
