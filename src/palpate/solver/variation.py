"""Mechanisms applied to the body and to the recorded signal; a specification beside another one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from palpate.mechanisms import MECHANISMS
from palpate.solver.instrument_drive import through_instrument
from palpate.study.protocol import DISPLACEMENT, LOAD, Protocol
from palpate.study.specification import Specification


def applied_to_body(specification: Specification) -> Specification:
    """Return the specification that is simulated, after its mechanisms have changed it.

    Under displacement control, what the instrument adds to the depth is subtracted from the displacement of the body.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    for key, values in specification.mechanisms.items():
        specification = MECHANISMS[key].simulate(specification, values)
    if specification.protocol.control == DISPLACEMENT:
        for key, values in specification.mechanisms.items():
            protocol = through_instrument(specification.protocol, MECHANISMS[key], values)
            specification = replace(specification, protocol=protocol)
    return specification


def applied_to_signal(specification: Specification, depth: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the recorded depth (n,) [nm] at a true `depth` (n,) [nm] under a `load` (n,) [mN]."""
    return _written(specification.mechanisms, specification.protocol.sample_time, load, depth)


def added_by_instrument(mechanisms: Mapping[str, Mapping[str, float]], protocol: Protocol) -> np.ndarray:
    """Return what mechanisms add to the recorded depth (n_points,) [nm].

    Zero where a displacement is prescribed: there it changes the displacement of the body.
    """
    none = np.zeros(len(protocol.sample_time))
    return none if protocol.control != LOAD else _written(mechanisms, protocol.sample_time, protocol.sample_load, none)


def _written(
    mechanisms: Mapping[str, Mapping[str, float]], time: np.ndarray, load: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    for key, values in mechanisms.items():
        depth = MECHANISMS[key].record(time, load, depth, values)
    return depth


@dataclass(frozen=True, eq=False)
class Variation:
    """A specification beside another one, with one parameter changed a little.

    Parameters
    ----------
    neighbour : Specification
    step
        By how much the parameter is changed, in its unit.
    """

    neighbour: Specification
    step: float
