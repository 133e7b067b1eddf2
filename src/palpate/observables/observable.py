r"""What an observable declares: a quantity that is simulated, recorded and compared.

An observable is one file of this folder. Data, inference, laboratory, results and figures take everything about it from
its declaration. Inference compares all observables by equivalent depths, so that noise, drift and misfit have one unit:
a response that is larger by dr counts as the change of depth under the same load, `Quantity.nm` times dr.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol


def noise_in_time(time: np.ndarray, of_site: np.ndarray) -> dict[str, np.ndarray]:
    """Return matrices (n, n) of the variance components of a response that is recorded in time [nm^2].

    They are the site's, a factor of each recording, and a random walk of the instrument.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Sample times [s].
    of_site : ndarray, shape (n,)
        What a site of unit deviation changes [nm].
    """
    return {"site": np.outer(of_site, of_site), "random_walk": np.minimum.outer(time, time)}


@dataclass(frozen=True, kw_only=True)
class Observable:
    """A quantity that is simulated, recorded and compared.

    Parameters
    ----------
    name
        In studies, results and messages.
    unit
        Of its values. Columns of tables are called ``NAME_UNIT``.
    control
        What is prescribed where it is the response: ``load`` or ``displacement``.
    of_simulation
        Gives it (n,) from a simulated curve, which has `time` [s], `load` [mN] and `depth` [nm], each (n,).
    of_recording
        Gives it (n,) at a protocol's sample times from a recording's time [s], load [mN] and depth [nm], each (m,).
    recorded
        Gives load (n,) [mN] and depth (n,) [nm] that an instrument writes, from the protocol, a simulated curve and the
        response (n,) in its place.
    scale
        Gives the change of depth under the same load [nm] that corresponds to one unit of it, and its relative change
        that corresponds to a relative change of depth, from the protocol, the indenter and the response (n,).
    noise
        Gives the matrices of its variance components, beside points that are correlated, see `noise_in_time`.
    adds_instrument
        Whether what an instrument adds to the recorded depth adds to it, too.
    drawn_over
        What it is drawn over: ``load``, whose axis then is the vertical one, or ``time``.
    """

    name: str
    unit: str
    control: str
    of_simulation: Callable[[Any], np.ndarray]
    of_recording: Callable[[Protocol, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    recorded: Callable[[Protocol, Any, np.ndarray], tuple[np.ndarray, np.ndarray]]
    scale: Callable[[Protocol, Indenter, np.ndarray], tuple[float, float]]
    noise: Callable[[np.ndarray, np.ndarray], dict[str, np.ndarray]] = noise_in_time
    adds_instrument: bool = False
    drawn_over: str = "time"

    @property
    def is_depth(self) -> bool:
        """Whether it is the depth under a prescribed load, of which the laws of sharp tips speak."""
        return self.name == "depth"

    @property
    def label(self) -> str:
        """Name and unit, as at an axis."""
        return f"{self.name} [{self.unit}]"

    def column(self, prefix: str) -> str:
        """Return the name of a table's column that holds it, such as ``recorded_nm``."""
        return f"{prefix}_{self.unit}"


@dataclass(frozen=True)
class Quantity:
    """An observable in one test.

    Parameters
    ----------
    observable
        What is compared.
    nm
        Change of depth under the same load that corresponds to one unit [nm].
    share
        Relative change of the response that corresponds to a relative change of depth under the same load; negative for
        a load.
    """

    observable: Observable
    nm: float = 1.0
    share: float = 1.0

    @classmethod
    def of(cls, observable: Observable, protocol: Protocol, indenter: Indenter, response: np.ndarray) -> Quantity:
        """Return the quantity of a test, with the scale that its observable has there.

        Parameters
        ----------
        observable
            What is compared.
        protocol, indenter
            Of the test.
        response : ndarray, shape (n,)
            At the sampling times, in the unit of the observable.
        """
        return cls(observable, *observable.scale(protocol, indenter, response))

    @property
    def name(self) -> str:
        """Name of the observable."""
        return self.observable.name

    @property
    def unit(self) -> str:
        """Unit of the observable."""
        return self.observable.unit
