"""What tests show of a solid before anything is simulated, and what a law takes from it as ranges of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

USUAL = "usual values"


class Guessed(NamedTuple):
    """What a parameter may be, one value where it is held constant, and why."""

    values: tuple[float, ...]
    why: str


@dataclass(frozen=True)
class Glimpse:
    """What tests show of a solid before anything is simulated.

    Parameters
    ----------
    modulus
        Young's modulus, about [GPa].
    hardness
        Load over the projected area of contact, about [GPa].
    shortest
        Shortest time of loading among the tests [s].
    soft
        Whether it is as soft as gels and rubbers, which creep in proportion to the stress.
    """

    modulus: float
    hardness: float
    shortest: float
    soft: bool = False


FirstGuess = Callable[[Glimpse], Mapping[str, Guessed]]
