"""What a mechanism of missing physics declares, and where it acts: before the simulation or on what is recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from palpate.parameters import Parameter, check_values
from palpate.protocol import LOAD
from palpate.specification import Specification

Values = Mapping[str, float]


@dataclass(frozen=True)
class Scale:
    """The size of a study, from which plausible amplitudes follow.

    Parameters
    ----------
    depth, load, modulus, duration, loading_time
        Largest depth [nm], largest load [mN], Young's modulus [GPa], longest test [s] and shortest loading [s].
    half_angle
        Nominal half-angle of the cone [deg]; 0 for a sphere.
    pressure
        Mean contact pressure [GPa].
    stated
        Ranges (lower, upper) that the study states in place of plausible ones, of a mechanism's quantity.
    """

    depth: float
    load: float
    modulus: float
    duration: float
    loading_time: float
    half_angle: float
    pressure: float
    stated: Mapping[str, Mapping[str, Sequence[float]]] = field(default_factory=dict)


@dataclass(frozen=True)
class Range:
    """Amplitudes that a diagnosis looks at, spread evenly; with `log`, their logarithms are.

    Parameters
    ----------
    lower, upper
        In the unit of the parameter.
    factor
        Whether the effect is in proportion to it, so that other amplitudes of the mechanism can make up for a factor.
    """

    lower: float
    upper: float
    log: bool = False
    factor: bool = False

    def physical(self, coordinate: np.ndarray) -> np.ndarray:
        """Return the values at coordinates in [0, 1]."""
        if self.log:
            return self.lower * (self.upper / self.lower) ** coordinate
        return self.lower + coordinate * (self.upper - self.lower)


def unchanged_specification(specification: Specification, values: Values) -> Specification:
    """Simulate what the base model says."""
    return specification


def same_values(values: Values, scale: Scale) -> Values:
    """Search among the parameters themselves."""
    return values


def unchanged_depth(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Record the depth as it is."""
    return depth


@dataclass(frozen=True)
class Mechanism:
    """One effect that a base model leaves out.

    Parameters
    ----------
    key, title
        Key of the contracts, and name for people.
    parameters
        Its amplitudes.
    neutral
        Values, or limits of values, at which it does nothing.
    source
        Where the effect is described.
    plausible
        Ranges, for a study of a given scale, within which a diagnosis looks unless the study states others.
    simulate
        Changes what is simulated: tip, material, load that acts.
    record
        Changes the depth (n,) [nm] that the instrument writes, from time [s], recorded load [mN] and true depth.
    varies
        Whether each recording has a value of its own.
    from_search
        Makes its parameters of the quantities that `plausible` spreads, where these are not the parameters themselves
        but others on which the curve depends more simply.
    solver_scatter
        Error of its simulated effect, relative to the effect and the same part of it everywhere: root mean square of
        what `standard` differs from `fine`, for some materials and amplitudes.
    shortcut
        What it makes of a known depth curve, nearly, with the arguments of `record`; only the rest must be learnt.
    """

    key: str
    title: str
    parameters: tuple[Parameter, ...]
    neutral: Values
    source: str
    plausible: Callable[[Scale], Mapping[str, Range]]
    simulate: Callable[[Specification, Values], Specification] = unchanged_specification
    record: Callable[[np.ndarray, np.ndarray, np.ndarray, Values], np.ndarray] = unchanged_depth
    varies: bool = False
    from_search: Callable[[Values, Scale], Values] = same_values
    solver_scatter: float = 0.0
    shortcut: Callable[[np.ndarray, np.ndarray, np.ndarray, Values], np.ndarray] | None = None

    @property
    def needs_learning(self) -> bool:
        """Whether it acts on the body: its effect, or the rest that cannot be derived, is learnt from simulations."""
        return self.simulate is not unchanged_specification

    def learnt_under(self, control: str) -> bool:
        """Return whether its effect on what answers to a load or a displacement must be learnt from simulations.

        What it adds to the depth is missing from a prescribed displacement, so that the body feels it.
        """
        return self.needs_learning or (control != LOAD and self.record is not unchanged_depth)

    def derived_under(self, control: str) -> bool:
        """Return whether its effect, or most of it, follows from the base model's curve."""
        return self.shortcut is not None or (control == LOAD and self.record is not unchanged_depth)

    def searched(self, scale: Scale) -> dict[str, Range]:
        """Return the ranges within which a diagnosis looks: what the study states, and what is plausible else."""
        ranges = dict(self.plausible(scale))
        for name, (lower, upper) in scale.stated.get(self.key, {}).items():
            ranges[name] = replace(ranges[name], lower=lower, upper=upper)
        return ranges

    def on_curve(self, time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
        """Return what it makes of the base model's curve (n,) [nm], as far as that can be derived."""
        return self.shortcut(time, load, depth, values) if self.shortcut else self.record(time, load, depth, values)

    def check(self, values: Mapping[str, object]) -> dict[str, float]:
        """Return all parameters by name, checked; raises `InputError`."""
        return check_values(self.parameters, values, f"mechanism {self.key}")
