"""What a constitutive law declares: its key, its parameters, and the terms of its flow."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.base.parameters import Parameter, check_values
from palpate.errors import InputError
from palpate.materials.first_guess import FirstGuess
from palpate.materials.flow.registry import number_of
from palpate.materials.flow.row import BACK, CREEP, HARDENING, LINEAR, PLASTIC, VOIGT, block, packed

YOUNGS_MODULUS = Parameter("youngs_modulus", "E", "GPa", 1e-12, 2000.0, "Young's modulus")
POISSON_RATIO = Parameter("poisson_ratio", r"\nu", "-", 0.0, 0.4999, "Poisson's ratio")
ELASTIC = (YOUNGS_MODULUS, POISSON_RATIO)


@dataclass(frozen=True)
class Creep:
    """Flow at the rate d e/dt = phi(q, p) s.

    Parameters
    ----------
    fluidity
        phi [1/GPa/s], see `palpate.materials.flow.registry.fluidity`.
    numbers
        What it reads of the row.
    pressed
        Whether it depends on the pressure.
    hardens
        Whether it depends on the equivalent strain of its flow.
    """

    fluidity: Callable[..., object]
    numbers: Sequence[float]
    pressed: bool = False
    hardens: bool = False

    @property
    def block(self) -> list[float]:
        """Block of a row, see `palpate.materials.flow.row`."""
        return block(HARDENING if self.hardens else CREEP, number_of(self.fluidity), 0.0, self.numbers)


@dataclass(frozen=True)
class Voigt:
    """A Voigt element, d e/dt + e/t = phi(q, p) s / t.

    Parameters
    ----------
    time
        Retardation time [s].
    fluidity, numbers, pressed
        As for `Creep`, phi in 1/GPa.
    """

    time: float
    fluidity: Callable[..., object]
    numbers: Sequence[float]
    pressed: bool = False

    @property
    def block(self) -> list[float]:
        """Block of a row, see `palpate.materials.flow.row`."""
        return block(VOIGT, number_of(self.fluidity), self.time, self.numbers)


@dataclass(frozen=True)
class LinearVoigt:
    """A linear Voigt element, d e/dt + e/t = J s / t; any number of them costs as much as one.

    Parameters
    ----------
    time
        Retardation time t [s].
    compliance
        J [1/GPa].
    """

    time: float
    compliance: float
    pressed: bool = field(default=False, init=False)

    @property
    def block(self) -> list[float]:
        """Block of a row, see `palpate.materials.flow.row`."""
        return block(LINEAR, 0, self.time, [self.compliance])


@dataclass(frozen=True)
class Yield:
    """Rate-independent flow, sqrt(3) q <= sigma(alpha, p).

    Parameters
    ----------
    strength
        sigma [GPa], see `palpate.materials.flow.registry.strength`.
    numbers, pressed
        As for `Creep`.
    """

    strength: Callable[..., object]
    numbers: Sequence[float]
    pressed: bool = False

    @property
    def block(self) -> list[float]:
        """Block of a row, see `palpate.materials.flow.row`."""
        return block(PLASTIC, number_of(self.strength), 0.0, self.numbers)


@dataclass(frozen=True)
class BackStress:
    """A stress X = (2/3) C e_f against all flow, in proportion to its strain e_f.

    Creep, yielding and Voigt elements that are not linear flow by s - X in place of s; e_f is their strain together.

    Parameters
    ----------
    modulus
        C [GPa].
    """

    modulus: float
    pressed: bool = field(default=False, init=False)

    @property
    def block(self) -> list[float]:
        """Block of a row, see `palpate.materials.flow.row`."""
        return block(BACK, 0, 0.0, [self.modulus])


Term = Creep | Voigt | LinearVoigt | Yield | BackStress


@dataclass(frozen=True)
class Law:
    """A constitutive law: Hooke's law and the strains of some terms, under the same stress.

    Parameters
    ----------
    key
        Name used in configurations.
    title
        Name used on figures.
    flow
        Parameters besides the elastic ones, `ELASTIC`.
    terms
        Maps checked values by name to the terms of the flow.
    extend
        Maps the names a user gives to the parameters of the flow, for laws with any number of elements.
    parts
        Keys of the laws that it joins; its own by default.
    example
        Values of the parameters of the flow, with which the law is tested.
    guess
        Ranges of the parameters of the flow for a draft, from what tests show of a solid.
    """

    key: str
    title: str
    flow: tuple[Parameter, ...]
    terms: Callable[[Mapping[str, float]], Sequence[Term]]
    extend: Callable[[Mapping[str, object]], tuple[Parameter, ...]] | None = None
    parts: tuple[str, ...] = ()
    example: Mapping[str, float] = field(default_factory=dict)
    guess: FirstGuess = lambda glimpse: {}

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", self.parts or (self.key,))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All parameters, of a law with as few elements as may be."""
        return (*ELASTIC, *self.flow)

    def declared(self, values: Mapping[str, object]) -> tuple[Parameter, ...]:
        """Return the parameters of the law as `values` spells it out."""
        return (*ELASTIC, *(self.extend(values) if self.extend else self.flow))

    def check(self, values: Mapping[str, object]) -> dict[str, float]:
        """Return all parameters by name, checked; raises `InputError`."""
        return check_values(self.declared(values), values, f"material model {self.key}")

    def check_together(self) -> None:
        """Refuse terms that cannot act together, whatever their values; raises `InputError`."""
        defaults = {p.name: p.default for p in self.flow if p.default is not None}
        terms = self.terms(defaults | dict(self.example))
        if sum(isinstance(term, Yield) or (isinstance(term, Creep) and term.hardens) for term in terms) > 1:
            raise InputError(
                f"{self.key} has more than one law that hardens with its plastic strain",
                remedy="leave one of them out",
                place="model",
            )
        back = any(isinstance(term, BackStress) for term in terms)
        if back and not any(isinstance(term, Creep | Voigt | Yield) for term in terms):
            raise InputError(
                f"{self.key} has no flow that a back stress acts against",
                remedy="join a law that flows, such as eyring+kinematic_hardening",
                place="model",
            )

    def coefficients(self, values: Mapping[str, object]) -> np.ndarray:
        """Return the row (c,) of `palpate.materials.flow.row` for `values`; raises `InputError`."""
        checked = self.check(values)
        modulus, ratio = checked["youngs_modulus"], checked["poisson_ratio"]
        terms = self.terms(checked)
        shear, bulk = modulus / (2 * (1 + ratio)), modulus / (3 * (1 - 2 * ratio))
        return packed(shear, bulk, [term.block for term in terms], any(term.pressed for term in terms))
