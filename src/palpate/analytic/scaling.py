"""The exact scaling laws of indentation: pairs of tests whose curves must be related, whatever the solver.

    load    h(t; k P) = sqrt(k) h(t; P)                     a sharp cone has no length
    stress  all stresses and P by c, compliances by 1/c, C_s by c^-(2 m_s + 1), C_t by c^-(2 m_t + 1): h unchanged
    time    times by b, rates and C_s by 1/b: h unchanged as a function of t/b

Each holds for every law of the radial family, small and large strains, with and without friction, loading and
unloading. Which parameter is a stress, a compliance, a time or a rate, its unit says.

Source: Y.-T. Cheng & C.-M. Cheng, Mater. Sci. Eng. R 44 (2004) 91-149, for the load; the others by dimensional
analysis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from palpate.errors import InputError
from palpate.materials import law_of
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification


def load_scaled(specification: Specification, factor: float) -> tuple[Specification, float]:
    """Return the test under `factor` times the load, and the ratio of its depths to the given test's.

    Raises
    ------
    InputError
        For an indenter with a length, for which there is no such law.
    """
    if not specification.indenter.sharp:
        raise InputError(
            f"the tip, a {specification.indenter.shape}, has a length",
            remedy="use a sharp cone or pyramid",
            place="indenter.shape",
        )
    return replace(specification, protocol=_protocol(specification.protocol, load=factor)), factor**0.5


def stress_scaled(specification: Specification, factor: float) -> Specification:
    """Return the test of a material with `factor` times all stresses, whose depths are those of the given test."""
    values = with_stresses_scaled(specification.model, specification.parameters, factor)
    return replace(specification, parameters=values, protocol=_protocol(specification.protocol, load=factor))


def with_stresses_scaled(model: str, parameters: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return the parameters of a model in which all stresses are `factor` times as large."""
    values = dict(parameters)
    for parameter in law_of(model).declared(values):
        power = {"GPa": 1.0, "1/GPa": -1.0}.get(parameter.unit, 0.0)
        if parameter.unit.startswith("GPa^-(2m"):
            power = -(2 * values[parameter.name.replace("coefficient", "exponent")] + 1)
        if power:
            values[parameter.name] *= factor**power
    return values


def time_scaled(specification: Specification, factor: float) -> Specification:
    """Return the test `factor` times as long on a material as much slower, whose depths are those of the given test."""
    values = dict(specification.parameters)
    for parameter in law_of(specification.model).declared(values):
        if parameter.unit.endswith("/s"):
            values[parameter.name] /= factor
        elif parameter.unit == "s":
            values[parameter.name] *= factor
    if "spectrum_coefficient" in values:  # the compliance at a time of 1 s, whatever the factor
        values["spectrum_coefficient"] *= factor ** -values["spectrum_exponent"]
    return replace(specification, parameters=values, protocol=_protocol(specification.protocol, time=factor))


def _protocol(protocol: Protocol, load: float = 1.0, time: float = 1.0) -> Protocol:
    return Protocol(protocol.knot_time * time, protocol.knot_load * load, protocol.sample_time * time)
