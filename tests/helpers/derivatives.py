"""Derivatives of simulated curves by parameters that are given by name."""

from dataclasses import replace

from palpate.materials import law_of
from palpate.mechanisms import MECHANISMS
from palpate.solver.simulation import differentiated
from palpate.solver.variation import Variation

STEP = 3e-5  # of the value, or of one unit, or of the test where a time is zero: derivatives err by about as much


def value_of(specification, name):
    """Return a parameter of the material by name, or of a mechanism as ``key.name``."""
    key, _, own = name.rpartition(".")
    return (specification.mechanisms[key] if key else specification.parameters)[own]


def at(specification, name, value):
    """Return the specification with one parameter changed."""
    key, _, own = name.rpartition(".")
    if not key:
        return replace(specification, parameters={**specification.parameters, own: value})
    mechanisms = {**specification.mechanisms, key: {**specification.mechanisms[key], own: value}}
    return replace(specification, mechanisms=mechanisms)


def varied(specification, name):
    """Return the specification with one parameter changed a little, upwards where it may grow."""
    key, _, own = name.rpartition(".")
    declared = MECHANISMS[key].parameters if key else law_of(specification.model).declared(specification.parameters)
    (parameter,) = (p for p in declared if p.name == own)
    value = value_of(specification, name)
    step = STEP * (abs(value) or (specification.protocol.knot_time[-1] if parameter.unit == "s" else 1.0))
    step = step if value + step <= parameter.upper else -step
    return Variation(at(specification, name, value + step), step)


def sensitivities_batch(specifications, names, radii=None):
    """Return each simulation, and the derivatives (n, p) of its response by the parameters."""
    return differentiated(specifications, [[varied(each, name) for name in names] for each in specifications], radii)


def sensitivities(specification, names, radii=None):
    """Return one simulation and its derivatives (n, p)."""
    return sensitivities_batch([specification], names, radii)[0]
