"""What a mechanism of missing physics declares: its effect on the simulated body or on the recorded signal.

A mechanism is one file of this folder. Simulation, diagnosis, blind trial and documents take everything about it from
its declaration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from palpate.base.parameters import Parameter, check_values
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.instrument_prior import InstrumentPrior
from palpate.study.protocol import LOAD
from palpate.study.specification import Specification

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
    half_angles
        The same of the further tips of a study, by their names.
    pressure
        Mean contact pressure [GPa].
    stated
        Ranges (lower, upper) that the study states in place of plausible ones, of a mechanism's quantity.
    instrument
        What an earlier study found of the instrument's effects: their prior; None without one.
    """

    depth: float
    load: float
    modulus: float
    duration: float
    loading_time: float
    half_angle: float
    pressure: float
    stated: Mapping[str, Mapping[str, Sequence[float]]] = field(default_factory=dict)
    half_angles: Mapping[str, float] = field(default_factory=dict)
    instrument: InstrumentPrior | None = None


@dataclass(frozen=True)
class Range:
    """Amplitudes that a diagnosis considers, uniform between the ends; with `log`, their logarithms are.

    With a `typical` size they have Cauchy's distribution about the middle instead, as errors of instruments do: most of
    them are small, and some are far larger.

    Parameters
    ----------
    lower, upper
        In the unit of the parameter.
    least, largest
        Limits, where they are narrower than those of the parameter, or the quantity is not a parameter.
    unit, meaning
        Of a quantity that is not a parameter.
    proportional
        Whether the effect grows about in proportion to the quantity, from none at zero, the lower end.
    typical
        Distance from the middle within which half of all instruments lie; none where the prior is even.
    """

    lower: float
    upper: float
    log: bool = False
    least: float = -np.inf
    largest: float = np.inf
    unit: str = "-"
    meaning: str = ""
    proportional: bool = False
    typical: float | None = None


def unchanged_specification(specification: Specification, values: Values) -> Specification:
    """Simulate what the base model says."""
    return specification


def same_values(values: Values, scale: Scale) -> Values:
    """Search among the parameters themselves."""
    return values


def unchanged_depth(time: np.ndarray, load: np.ndarray, depth: np.ndarray, values: Values) -> np.ndarray:
    """Record the depth as it is.

    Parameters
    ----------
    time, load, depth : ndarray, shape (n,)
        Time [s], recorded load [mN] and true depth [nm].
    values
        Parameters of the mechanism by name.
    """
    return depth


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """One effect that a base model leaves out.

    Parameters
    ----------
    key, title
        Key in studies and results, and name for people.
    family
        What it belongs to, such as the drift or the tip: the part of an answer that is often certain where the
        mechanism itself is not.
    effect
        What it does to a recording, in a few words.
    parameters
        Its amplitudes, and what else its effect depends on.
    neutral
        Values, or limits of values, at which it has no effect.
    example
        Values with a clear effect in a test of a polymer under 1 mN.
    source
        Where the effect is described.
    plausible
        Ranges that a diagnosis searches for a study of a given scale, unless the study states others.
    concealed
        Draws values for a recording of the blind trial that conceals it: a polymer under a cone, 0.1 to 10 mN.
    simulate
        Changes what is simulated: tip, material, load that acts.
    record
        Gives the recorded depth (n,) [nm] from time [s], recorded load [mN] and true depth [nm].
    follows_depth
        Whether what it adds to a recorded depth depends on the true depth, not on time and load alone.
    by_test_order
        Whether what `record` adds counts as often as tests were made since the mean one.
    varies
        Whether each recording has amplitudes of its own; further parameters are the same in all.
    averages_out
        Whether amplitudes that each recording has for itself are zero in the mean by nature, as where each has a phase.
    course_covariance
        Gives the covariance (n, n) of what one unit of its amplitude adds to recordings that differ in more than
        amplitudes, from time [s], load [mN] and parameters; None where amplitudes are all that differs.
    from_search
        Gives its parameters from the quantities of `plausible`, where these are not the parameters themselves but
        others on which the curve depends more simply.
    solver_scatter
        Relative error of its simulated effect, common to the whole effect: root mean square difference of `standard`
        and `fine` accuracy, over some materials and amplitudes.
    assumed
        Gives the values that a study's tip has without it; by default these are the neutral ones.
    background
        Standard deviation between recordings of an amplitude that every instrument has, in the amplitude's unit: so
        much counts as noise, not as the effect.
    breaks
        Assumptions of exact laws that do not hold where it acts: those laws do not apply to an explanation with it.
    unidentifiable_at_one_load
        Whether the material's parameters can compensate its effect in tests that all reach the same load.
    of_the_tip
        Whether it belongs to the tip, so that a test with another tip is free of it.
    of_the_instrument
        Whether it is a property of the instrument, the same in every test and under every tip.
    tip
        Name of the tip whose own it is, see `of_tip`; empty for the study's tip.
    remedy
        The test that measures its amplitude independently of the material, in words; empty where there is none.
    includes
        Keys of its special cases: mechanisms whose parameters it has, too, and which it equals where its other
        parameters have no effect. It fits whatever they fit, and is identified only where they do not suffice.
    by_default
        Whether a diagnosis considers it where the study names no mechanisms. One that includes another differs little
        from it in most recordings: it costs a fit where the other one acts, and adds tests of the same residuals.
    """

    key: str
    title: str
    family: str
    effect: str
    parameters: tuple[Parameter, ...]
    neutral: Values
    example: Values
    source: str
    plausible: Callable[[Scale], Mapping[str, Range]]
    concealed: Callable[[np.random.Generator], Values]
    simulate: Callable[[Specification, Values], Specification] = unchanged_specification
    record: Callable[[np.ndarray, np.ndarray, np.ndarray, Values], np.ndarray] = unchanged_depth
    follows_depth: bool = False
    by_test_order: bool = False
    varies: bool = False
    averages_out: bool = False
    course_covariance: Callable[[np.ndarray, np.ndarray, Values], np.ndarray] | None = None
    from_search: Callable[[Values, Scale], Values] = same_values
    solver_scatter: float = 0.0
    assumed: Callable[[Specification], Values] | None = None
    background: float = 0.0
    breaks: frozenset[Assumption] = frozenset()
    unidentifiable_at_one_load: bool = False
    of_the_tip: bool = False
    of_the_instrument: bool = False
    tip: str = ""
    remedy: str = ""
    includes: tuple[str, ...] = ()
    by_default: bool = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Names of the parameters that are zero where it has no effect; what it adds to a depth is linear in them."""
        return tuple(p.name for p in self.parameters if self.neutral[p.name] == 0.0)

    @property
    def acts_on_body(self) -> bool:
        """Whether it changes what is simulated, not only what is recorded."""
        return self.simulate is not unchanged_specification

    @property
    def may_be_shared(self) -> bool:
        """Whether studies on one instrument may share it: it has one value for the instrument, or for a tip of it."""
        return self.of_the_instrument or self.of_the_tip

    def of_tip(self, name: str) -> Mechanism:
        """Return the same mechanism of another tip of a study, with amplitudes of its own: ``KEY[NAME]``."""
        return replace(
            self,
            key=f"{self.key}[{name}]",
            title=f"{self.title} of {name}",
            family=f"{self.family}[{name}]",
            plausible=lambda s: self.plausible(replace(s, half_angle=s.half_angles[name])),
            tip=name,
        )

    def acts_under(self, tip: str) -> bool:
        """Return whether it acts in tests with the tip of this name, which is empty for the study's own."""
        return not self.of_the_tip or self.tip == tip

    def applied(self, specification: Specification, values: Values) -> Specification:
        """Return what is simulated with it; the same with a tip that is free of it."""
        return self.simulate(specification, values) if self.acts_under(specification.tip) else specification

    def is_simulated_under(self, control: str) -> bool:
        """Return whether its effect changes the simulation of a test under this control.

        Where a displacement is prescribed, what it adds to the depth reduces the displacement of the body.
        """
        return self.acts_on_body or (control != LOAD and self.record is not unchanged_depth)

    def searched(self, scale: Scale) -> dict[str, Range]:
        """Return the ranges that a diagnosis searches: those that the study states, else the plausible ones.

        A range that is stated for an instrument holds half of the prior, whose middle it moves. An effect with a prior
        from an earlier study has the ranges of that study, so that its coordinates have the same meaning in both.
        """
        ranges = dict(self.plausible(scale))
        for name, (lower, upper) in scale.stated.get(self.key, {}).items():
            typical = None if ranges[name].typical is None else 0.5 * (upper - lower)
            ranges[name] = replace(ranges[name], lower=lower, upper=upper, typical=typical)
        earlier = scale.instrument.ranges.get(self.key, {}) if scale.instrument else {}
        return ranges | {name: replace(ranges[name], **asdict(each)) for name, each in earlier.items()}

    def limits(self, name: str, searched: Range) -> tuple[float, float]:
        """Return the limits of a quantity that is searched: those of the range, and of the parameter if it is one."""
        own = next((p for p in self.parameters if p.name == name), None)
        if own is None:
            return searched.least, searched.largest
        return max(own.lower, searched.least), min(own.upper, searched.largest)

    def check(self, values: Mapping[str, object]) -> dict[str, float]:
        """Return all parameters by name, checked; raises `InputError`."""
        return check_values(self.parameters, values, f"mechanism {self.key}")
