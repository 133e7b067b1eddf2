r"""Nonlinear Burgers solid: Hooke, power-law steady creep, and Voigt elements driven by a power of the stress.

$$\dot\varepsilon_s = C_s J_2^{m_s} s, \qquad
\dot\varepsilon_t + \frac{\varepsilon_t}{t_\epsilon} = \frac{C_t}{t_\epsilon} J_2^{m_t} s$$

with one equation of the second kind for each Voigt element. Creep is isochoric. $J_2 = s:s/2$ is in GPa², so the unit
of $C_s$ is $\mathrm{GPa}^{-(2 m_s + 1)} \, \mathrm{s}^{-1}$, and that of $C_t$ is $\mathrm{GPa}^{-(2 m_t + 1)}$.
"""

from __future__ import annotations

from collections.abc import Mapping

from palpate.base.parameters import Parameter
from palpate.materials.first_guess import USUAL, Glimpse, Guessed
from palpate.materials.flow.arithmetic import constant, entry, exponential, where_less
from palpate.materials.flow.registry import fluidity
from palpate.materials.law import Creep, Law, Term, Voigt

EPOXY_MODULUS = 3.25  # GPa, of the solid whose creep the guesses are taken from, see config/config.yaml
LIKE_EPOXY = "from none to about three times the creep of an epoxy at like stress"
STEADY = (
    Parameter("steady_coefficient", "C_s", "GPa^-(2m_s+1)/s", 0.0, 1e9, "coefficient of steady creep"),
    Parameter("steady_exponent", "m_s", "-", 0.0, 10.0, "exponent of J2 in steady creep"),
)
VOIGT = (
    Parameter("transient_coefficient", "C_t", "GPa^-(2m_t+1)", 0.0, 1e9, "coefficient of transient creep"),
    Parameter("transient_exponent", "m_t", "-", 0.0, 10.0, "exponent of J2 in transient creep"),
    Parameter("retardation_time", r"t_\epsilon", "s", 1e-6, 1e9, "retardation time of the Voigt element"),
)


@fluidity
def power_of_stress(law, at, q, log_q, pressure, alpha, gain):
    """Return C J2^m = C q^(2 m), its derivatives by ln q, and none by the pressure.

    Arguments and result are those of `palpate.materials.flow.registry.fluidity`.
    """
    coefficient, exponent = entry(law, at), entry(law, at + 1)
    power, lowest = exponent * log_q, constant(q, -700.0)
    value = coefficient * exponential(where_less(power, lowest, lowest, power))
    slope = exponent * value
    return value, slope, exponent * slope, constant(q, 0.0)


def voigt_elements(values: Mapping[str, object]) -> tuple[Parameter, ...]:
    """Return the parameters of all Voigt elements that `values` names (``..._2``, ``..._3`` for further ones)."""
    count = 1
    while any(f"{p.name}_{count + 1}" in values for p in VOIGT):
        count += 1
    further = tuple(
        Parameter(f"{p.name}_{k}", f"{p.symbol}^{{({k})}}", p.unit, p.lower, p.upper, f"{p.meaning}, element {k}")
        for k in range(2, count + 1)
        for p in VOIGT
    )
    return VOIGT + further


def terms(values: Mapping[str, float]) -> list[Term]:
    """Return steady creep and the Voigt elements, in order."""
    numbers = [values[p.name] for p in voigt_elements(values)]
    steady = Creep(power_of_stress, (values["steady_coefficient"], 2.0 * values["steady_exponent"]))
    elements = zip(numbers[::3], numbers[1::3], numbers[2::3], strict=True)
    return [steady, *(Voigt(t_eps, power_of_stress, (c_t, 2.0 * m_t)) for c_t, m_t, t_eps in elements)]


def guess(glimpse: Glimpse) -> dict[str, Guessed]:
    """Return from no creep to about three times that of an epoxy whose stresses grow with the modulus.

    What recovers does so in a time between a five-hundredth and four tenths of the shortest loading. Gels and rubbers,
    far below the stresses of plastics, creep in proportion to the stress.
    """
    stress = glimpse.modulus / EPOXY_MODULUS
    times = (0.002 * glimpse.shortest, 0.4 * glimpse.shortest)
    found = {"retardation_time": Guessed(times, "a five-hundredth to four tenths of the shortest loading")}
    if glimpse.soft:
        steady = (0.0, 0.5 / (glimpse.modulus * glimpse.shortest))
        return found | linear_creep(steady, (0.0, 1.0 / glimpse.modulus), "linear creep, as of gels and rubbers")
    return found | {
        "steady_coefficient": Guessed((0.0, 0.2 * stress**-1.5), LIKE_EPOXY),
        "steady_exponent": Guessed((0.1, 0.8), USUAL),
        "transient_coefficient": Guessed((0.0, 0.6 * stress**-1.6), LIKE_EPOXY),
        "transient_exponent": Guessed((0.1, 0.8), USUAL),
    }


def linear_creep(steady: tuple[float, ...], transient: tuple[float, ...], why: str) -> dict[str, Guessed]:
    """Return creep in proportion to the stress, with ranges of its coefficients [1/GPa/s], [1/GPa]."""
    none = Guessed((0.0,), why)
    return {
        "steady_coefficient": Guessed(steady, why),
        "steady_exponent": none,
        "transient_coefficient": Guessed(transient, why),
        "transient_exponent": none,
    }


LAW = Law(
    "nonlinear_burgers",
    "nonlinear Burgers",
    STEADY + VOIGT,
    terms,
    lambda values: (*STEADY, *voigt_elements(values)),
    example={
        "steady_coefficient": 0.09,
        "steady_exponent": 0.2,
        "transient_coefficient": 0.24,
        "transient_exponent": 0.47,
        "retardation_time": 0.25,
    },
    guess=guess,
)
