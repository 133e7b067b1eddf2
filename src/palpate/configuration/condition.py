"""A loading condition of a study, and the condition that the parts of it are that are held out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from indentation_files.recording import Recording
from palpate.configuration.checked_file import suggestion
from palpate.configuration.prescribed_history import Histories
from palpate.configuration.tips import tip_name
from palpate.errors import InputError, part_of
from palpate.observables import Observable, response_to
from palpate.study.held_out import Parts, divided, inside
from palpate.study.protocol import Protocol


@dataclass(frozen=True)
class Condition:
    """One loading condition of a study.

    Parameters
    ----------
    name
        Such as ``P1.00_T030``; recordings of it are ``NAME_REPLICATE.csv``.
    role
        ``calibrate``, or ``validate``: held out of calibrations, to validate them.
    protocol
        What is prescribed, and sampling times.
    follows
        What the history was taken from, `palpate.configuration.prescribed_history.RECORDED` or a file; empty where
        numbers prescribe it.
    own_loads
        Whether recordings of it reach loads of their own, as under depth or strain-rate control.
    held_out
        Parts of the test that are held out: the protocol has no samples there.
    part_of
        Name of the condition of which these are the parts that are held out; empty for a condition of its own.
    tip
        Name of a tip of its own; empty for that of the study.
    order
        When its recordings were made: tests since the mean one of a set.
    """

    name: str
    role: str
    protocol: Protocol
    follows: str = ""
    own_loads: bool = False
    held_out: Parts = ()
    part_of: str = ""
    tip: str = ""
    order: float = 1.0

    @property
    def observable(self) -> Observable:
        """What its tests are compared by."""
        return response_to(self.protocol)

    @property
    def test(self) -> str:
        """Name of the condition whose recordings are those of this one."""
        return self.part_of or self.name

    def counted(self, recording: Recording) -> Recording:
        """Return the points of a recording of it that are not held out."""
        duration = recording.time[-1] if self.own_loads else self.protocol.knot_time[-1]
        return recording.at(~inside(recording.time * (self.protocol.knot_time[-1] / duration), self.held_out))


def conditions_of_entry(index: int, entry: Mapping[str, Any], histories: Histories, least: int) -> list[Condition]:
    """Return the condition of an entry, and that of its parts that are held out; raises `InputError` with the place.

    Parameters
    ----------
    index
        Number of the entry, from 0.
    entry
        Its keys.
    histories
        Where its history comes from.
    least
        Samples that must not be held out.
    """
    follows, own_loads = entry.get("load_history", ""), entry.get("own_loads", False)
    name, role, tip = entry["name"], entry.get("role", "calibrate"), tip_name(entry.get("indenter"))
    with part_of(f"conditions[{index}] ({name})"):
        protocol = histories.protocol(entry)
        if "held_out" not in entry:
            return [Condition(name, role, protocol, follows, own_loads, tip=tip)]
        if role != "calibrate":
            raise InputError("with role: validate all of a test is held out", remedy="keep one", place="held_out")
        parts, counted, rest = divided(protocol, entry["held_out"], least)
    return [
        Condition(name, role, counted, follows, own_loads, held_out=parts, tip=tip),
        Condition(f"{name}.held_out", "validate", rest, follows, own_loads, part_of=name, tip=tip),
    ]


def condition_sets_of(
    given: Mapping[str, Sequence[str]], conditions: tuple[Condition, ...]
) -> dict[str, tuple[str, ...]]:
    """Return the names of the conditions that each calibration uses; ``all`` has all with the role ``calibrate``.

    Parameters
    ----------
    given
        The section ``condition_sets``.
    conditions
        All conditions of the study.

    Raises
    ------
    InputError
        When no condition is fitted, a set names one that is not, or ``all`` lacks one.
    """
    calibrate = tuple(condition.name for condition in conditions if condition.role == "calibrate")
    if not calibrate:
        raise InputError("no condition has the role calibrate", remedy="give one that role", place="conditions")
    for key, names in given.items():
        for name in names:
            if name not in calibrate:
                there = name in [condition.name for condition in conditions]
                raise InputError(
                    f"{name!r} {'has the role validate' if there else 'is no condition'}{suggestion(name, calibrate)}",
                    remedy=f"use calibrate conditions: {', '.join(calibrate)}",
                    place=f"condition_sets.{key}",
                )
    if left := [name for name in calibrate if name not in given.get("all", calibrate)]:
        raise InputError(
            f"{left[0]!r} has the role calibrate, and is not in the set of all such conditions",
            remedy="give it role: validate, or the set another name",
            place="condition_sets.all",
        )
    return {"all": calibrate} | {key: tuple(names) for key, names in given.items()}
