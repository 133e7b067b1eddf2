"""The amplitudes of mechanisms that only add to the recorded depth, which does so in proportion to each of them.

Where such a mechanism varies, each recording has amplitudes of its own: what one unit of an amplitude adds under a
condition is then the column c of a variance component v c c^T (`palpate.data.noise`). Other parameters, such as
the time in which a transient decays, belong to the instrument and are the same in every recording.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.mechanism import Values
from palpate.study.protocol import Protocol

PROBE = np.geomspace(1e-3, 1e3, 30)  # s or mN


@dataclass(frozen=True, order=True)
class Amplitude:
    """One amplitude of a mechanism.

    Parameters
    ----------
    key, name
        The mechanism, and its parameter.
    beside
        Values of the mechanism's parameters that are not amplitudes.
    """

    key: str
    name: str
    beside: tuple[tuple[str, float], ...] = ()

    @classmethod
    def of(cls, key: str, values: Values) -> tuple[Amplitude, ...]:
        """Return all amplitudes of a mechanism that has parameters `values`.

        Two amplitudes with the same effect compare equal, so that a noise model with them is fitted once: further
        parameters are rounded to three digits, and where they make no difference their neutral values are taken.
        """
        mechanism, found = MECHANISMS[key], []
        others = [p.name for p in mechanism.parameters if p.name not in mechanism.amplitudes]
        for name in mechanism.amplitudes:
            here = cls(key, name, tuple((other, float(f"{values[other]:.3g}")) for other in others))
            plain = cls(key, name, tuple((other, mechanism.neutral[other]) for other in others))
            found.append(plain if np.array_equal(here.added(PROBE, PROBE), plain.added(PROBE, PROBE)) else here)
        return tuple(found)

    def __str__(self) -> str:
        return f"{self.key}.{self.name}"

    def parameters(self, value: float) -> dict[str, float]:
        """Return the parameters of the mechanism when this amplitude alone has a value."""
        return {**dict.fromkeys(MECHANISMS[self.key].amplitudes, 0.0), **dict(self.beside), self.name: value}

    def added(self, time: np.ndarray, load: np.ndarray) -> np.ndarray:
        """Return what one unit adds to the depth (n,) [nm] at times [s] and loads [mN]."""
        return MECHANISMS[self.key].record(time, load, np.zeros_like(time), self.parameters(1.0))

    @property
    def components(self) -> tuple[str, ...]:
        """Names of its variance components; ``key.course`` is there where its course is random, too."""
        return (str(self), *([f"{self.key}.course"] if MECHANISMS[self.key].course_covariance else []))

    def covariances(self, column: np.ndarray, protocol: Protocol) -> list[np.ndarray]:
        """Return the matrices (n, n) of these under a history in which one unit adds a `column` (n,) [nm]."""
        found, course = [np.outer(column, column)], MECHANISMS[self.key].course_covariance
        if course:
            found.append(course(protocol.sample_time, protocol.sample_load, self.parameters(1.0)))
        return found


def own_amplitudes(values: Mapping[str, Values]) -> tuple[Amplitude, ...]:
    """Return the amplitudes of which each recording has its own, of an explanation with parameters `values`."""
    return tuple(sorted(a for key in values if MECHANISMS[key].varies for a in Amplitude.of(key, values[key])))
