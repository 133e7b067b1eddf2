"""Mechanisms applied to the body and to the recorded signal; a specification beside another one.

Under displacement control an instrument's own errors act on the displacement that it prescribes. Recorded depth h_r and
load F belong to it, z = h_r + C F. Where the instrument adds g(t, F) to the depth, such as drift or the frame's
compliance, the body's depth h = h_r - g meets another displacement,

    h + C F + g(t, F) = z(t).

With g = g_0(t) + c F that is a drive of z - g_0 through a compliance of C + c: what disturbs the depth at a given load
changes the load in response. Where contact was found too late, so that the body is touched before time zero, the drive
rises to its initial value within a fifth of the time to the first sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS, Mechanism
from palpate.mechanisms.mechanism import Values, unchanged_depth
from palpate.observables import response_to
from palpate.study.protocol import DISPLACEMENT, Protocol
from palpate.study.specification import Specification

LINEAR = 1e-9  # relative and absolute [nm], within which what is added counts as linear
AT_ONCE = 0.2  # of the time to the first sample; chosen


def applied_to_body(specification: Specification) -> Specification:
    """Return the specification that is simulated, after its mechanisms have changed it.

    Under displacement control, what the instrument adds to the depth is subtracted from the displacement of the body.

    Raises
    ------
    InputError
        When a mechanism cannot act on this material or indenter.
    """
    for key, values in specification.mechanisms.items():
        specification = MECHANISMS[key].applied(specification, values)
    if specification.protocol.control == DISPLACEMENT:
        for key, values in specification.mechanisms.items():
            protocol = through_instrument(specification.protocol, MECHANISMS[key], values)
            specification = replace(specification, protocol=protocol)
    return specification


def through_instrument(protocol: Protocol, mechanism: Mechanism, values: Values) -> Protocol:
    """Return the drive applied to the body where a mechanism adds to the recorded depth.

    Raises
    ------
    InputError
        When what it adds is not linear in the load.
    """
    if mechanism.record is unchanged_depth:
        return protocol
    refused = InputError(
        f"{mechanism.title} under displacement control: what it adds to the depth is not linear in the load",
        remedy="leave it out, or use tests under load control",
        place=f"mechanisms.{mechanism.key}",
    )
    if mechanism.follows_depth:
        raise refused
    time = np.union1d(protocol.knot_time, protocol.sample_time)

    def added(load: float) -> np.ndarray:
        return mechanism.record(time, np.full(len(time), load), np.zeros(len(time)), values)

    none, *slopes = added(0.0), *(added(load) - added(0.0) for load in (1.0, 2.0))
    compliance = slopes[0][0]
    if not np.allclose(slopes, np.outer((1.0, 2.0), np.full(len(time), compliance)), rtol=LINEAR, atol=LINEAR):
        raise refused
    drive = protocol.drive_at(time) - none
    kept = np.isin(time, protocol.knot_time)
    if not np.allclose(np.interp(time, time[kept], drive[kept]), drive, rtol=0.0, atol=LINEAR * protocol.largest_drive):
        kept[:] = True
    time, drive = time[kept], drive[kept]
    if drive[0] > 0.0:
        risen = AT_ONCE * min(protocol.sample_time[0], time[1])
        time, drive = np.insert(time, 1, risen), np.concatenate([[0.0, np.interp(risen, time, drive)], drive[1:]])
    return replace(protocol, knot_time=time, knot_drive=drive, compliance=protocol.compliance + float(compliance))


def applied_to_signal(specification: Specification, depth: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the recorded depth (n,) [nm] at a true `depth` (n,) [nm] under a `load` (n,) [mN]."""
    return written(specification.mechanisms, specification.protocol.sample_time, load, depth)


def added_by_instrument(
    mechanisms: Mapping[str, Mapping[str, float]], protocol: Protocol, depth: np.ndarray, order: float = 1.0
) -> np.ndarray:
    """Return what mechanisms add (n_points,) [nm].

    Zero where a displacement is prescribed: there it changes the displacement of the body.

    Parameters
    ----------
    mechanisms
        Parameters by key.
    protocol
        Of the test.
    depth : ndarray, shape (n_points,)
        True depth [nm].
    order
        See `written`.
    """
    if not response_to(protocol).adds_instrument:
        return np.zeros(len(protocol.sample_time))
    return written(mechanisms, protocol.sample_time, protocol.sample_load, depth, order) - depth


def written(
    mechanisms: Mapping[str, Mapping[str, float]],
    time: np.ndarray,
    load: np.ndarray,
    depth: np.ndarray,
    order: float = 1.0,
) -> np.ndarray:
    """Return the recorded depth (n,) [nm] after mechanisms have acted on a true `depth` (n,) [nm].

    Parameters
    ----------
    mechanisms
        Parameters by key.
    time, load : ndarray, shape (n,)
        [s] and [mN].
    order
        Tests since the mean one, where an effect grows from test to test.
    """
    for key, values in mechanisms.items():
        once = MECHANISMS[key].record(time, load, depth, values)
        depth = depth + order * (once - depth) if MECHANISMS[key].by_test_order else once
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
