r"""Eyring flow that hardens with the strain that it has flowed.

$$\dot\varepsilon = \frac{3}{2} \frac{s}{\sigma_e} r_0 \sinh\left(\frac{\sigma_e}{\sigma_0}\right)
\exp\left(-\frac{\mu p + H \alpha}{\sigma_0}\right), \qquad \sigma_e = \sqrt{3 J_2}$$

$\alpha$ is the equivalent strain of this flow, and the other symbols are those of `eyring`. Under a constant rate the
stress rises by $H \alpha$, well above $\sigma_0$.

With $\alpha = \alpha_0 + g \varphi$ at the end of a step the fluidity has the closed form

$$\ln \varphi = \ln \varphi_0 - w, \qquad w + \ln w = \ln(\varphi_0 H g / \sigma_0),$$

with Lambert's $w$ and the fluidity $\varphi_0$ at $\alpha_0$. Logarithms keep it within the range of numbers.

Source: E.T.J. Klompen et al., Macromolecules 38 (2005) 6997-7008, for a factor on the rate of Eyring flow that follows
from its strain; R. Iacono and J.P. Boyd, Adv. Comput. Math. 43 (2017) 1403-1436, equation 9, for Lambert's function.
"""

from __future__ import annotations

from numba import njit

from palpate.base.parameters import Parameter
from palpate.materials.eyring import FLOW as EYRING
from palpate.materials.eyring import ROOT3, SMALL, STEEPEST
from palpate.materials.eyring import guess as guess_eyring
from palpate.materials.first_guess import Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, exponential, log_of_one_plus, logarithm, where_less
from palpate.materials.flow.registry import fluidity
from palpate.materials.law import Creep, Law

FLOW = (*EYRING, Parameter("hardening", "H", "GPa", 0.0, 1e3, "rise of the stress with the strain at a constant rate"))
LEAST, LOWEST = 1e-290, -650.0  # that stand for zero and its logarithm
LARGE = 30.0  # x, from which ln(1 + exp(x)) is x


@njit(forceinline=True)
def lambert(x):
    """Return w of w + ln w = x, to rounding: each iteration squares an error of first a fiftieth."""
    lowest, large = constant(x, LOWEST), constant(x, LARGE)
    x = where_less(x, lowest, lowest, x)
    log = where_less(x, large, log_of_one_plus(exponential(where_less(x, large, x, large))), x)
    w = log * (1.0 - log_of_one_plus(log) / (2.0 + log))
    for _ in range(3):
        w = w / (1.0 + w) * (1.0 + x - logarithm(w))
    return w


@fluidity
def hardened_sinh(law, at, q, log_q, pressure, alpha, gain):
    """Return phi and its derivatives: with b = ln phi_0, (1 + w) d ln phi = db - w d ln q.

    Arguments and result are those of `palpate.materials.flow.registry.fluidity`.
    """
    rate, inverse, mu, hardening = entry(law, at), 1.0 / entry(law, at + 1), entry(law, at + 2), entry(law, at + 3)
    none, small, least, steepest = constant(q, 0.0), constant(q, SMALL), constant(q, LEAST), constant(q, STEEPEST)
    z = ROOT3 * q * inverse
    square, doubled = z * z, 2.0 * where_less(z, small, small, z)
    # b = ln(sinh(z) / z) and what does not depend on q; series of z coth(z) and of its derivative by ln z.
    falling = exponential(none - where_less(doubled, constant(q, -LOWEST), doubled, constant(q, -LOWEST)))
    series = 1.0 + square * (1 / 6) * (1.0 + square * (1 / 20) * (1.0 + square * (1 / 42) * (1.0 + square * (1 / 72))))
    ratio = where_less(z, small, series, (1.0 - falling) / doubled)
    coth = 0.5 * doubled * (1.0 + falling) / (1.0 - falling)
    sharp = doubled * doubled * falling / ((1.0 - falling) * (1.0 - falling))
    bend = square * (1 / 3) * (1.0 + square * (1 / 10) * (1.0 + square * (1 / 28) * (1.0 + square * (1 / 54)))) / series
    first = where_less(z, small, bend, coth - 1.0)
    second = where_less(z, small, square - first - first * first, coth - sharp)
    scale = 1.5 * where_less(rate, least, least, rate) * inverse
    b = where_less(z, small, none, z) + logarithm(scale * ratio) - inverse * (mu * pressure + hardening * alpha)
    stiffening = hardening * inverse * gain
    w = lambert(b + logarithm(where_less(stiffening, least, least, stiffening)))
    share, exponent, lowest = 1.0 / (1.0 + w), b - w, constant(q, LOWEST)
    exponent = where_less(exponent, lowest, lowest, exponent)
    beyond = exponent - steepest
    value = exponential(where_less(none, beyond, steepest, exponent))
    slope = where_less(none, beyond, none, (first - w) * share)
    curve = where_less(none, beyond, none, (second - w * (1.0 + slope) * (1.0 + slope)) * share)
    return value, value * slope, value * (curve + slope * slope), none - mu * inverse * share * value


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return ranges of those of Eyring flow and of the hardening."""
    return guess_eyring(glimpse) | {"hardening": Guessed((0.0, 0.1 * glimpse.modulus), "up to a tenth of the modulus")}


LAW = Law(
    "hardening_eyring",
    "hardening Eyring flow",
    FLOW,
    lambda values: [Creep(hardened_sinh, [values[p.name] for p in FLOW], pressed=True, hardens=True)],
    example={"reference_rate": 1e-8, "eyring_stress": 0.004, "pressure_coefficient": 0.1, "hardening": 0.2},
    guess=guess,
)
