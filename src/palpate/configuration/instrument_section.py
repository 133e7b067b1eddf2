"""The section ``instrument`` of a study: effects that it shares with others, and what an earlier study found of them.

What a study finds is a result, ``results/STUDY/instrument.json``. It holds the record of its own prior, and so of every
study that it rests on, with the checksums of their recordings: no recordings may count twice.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.checksum import checksum
from palpate.configuration.study_sections import InstrumentSection, StudyFile
from palpate.errors import InputError, part_of
from palpate.mechanisms import MECHANISMS, known
from palpate.mechanisms.instrument_prior import InstrumentPrior, JointAmplitudes, SearchedRange, pooled_by_shared

ENDING = ".json"


def instrument_file(study: str) -> Path:
    """Return the file of what a study of this name finds of its instrument."""
    return Path("results", study, "instrument.json")


@dataclass(frozen=True)
class Instrument:
    """An instrument, and what is known of it.

    Attributes
    ----------
    name
        Its name.
    shares
        Keys of the mechanisms that studies share.
    file
        The file of the prior; None without one.
    record
        Its content; empty without one.
    prior
        What it says of the shared mechanisms.
    """

    name: str
    shares: tuple[str, ...]
    file: Path | None = None
    record: Mapping[str, Any] = field(default_factory=dict)
    prior: InstrumentPrior | None = None

    @property
    def in_words(self) -> str:
        """What is shared, and what an earlier study found of it."""
        titles = [MECHANISMS[key].title for key in self.shares]
        if not self.record:
            return f"Shared with other studies on {self.name}: {', '.join(titles)}."
        chances = [
            f"{title} {self.record['inclusion'][key]:.2g}" for title, key in zip(titles, self.shares, strict=True)
        ]
        return f"Prior from {self.record['study']} on {self.name}, probability that it acts: {', '.join(chances)}."

    def check_data(self, files: Iterable[Path]) -> None:
        """Refuse recordings that made the prior, or one that it rests on; raises `InputError`."""
        for file in files if self.record else ():
            found = checksum(file)
            for each in _chain(self.record):
                if found in each["recordings"].values():
                    problem = f"{file} is among the recordings of {each['study']}, which made the prior"
                    remedy = "name a prior from other recordings, or leave it out: no recording may count twice"
                    raise InputError(problem, remedy=remedy, place="instrument.prior")


def instrument_record(study: str, instrument: Instrument, found: Mapping[str, Any], files: Iterable[Path]) -> Any:
    """Return the content of ``instrument.json``.

    Parameters
    ----------
    study
        Name of the study.
    found
        Posterior of the shared effects, see `palpate.diagnosis.instrument_posterior`.
    files
        The recordings from which it follows.
    """
    sums = {str(file): checksum(file) for file in files}
    return {"name": instrument.name, "study": study, **found, "recordings": sums, "prior": instrument.record or None}


def instrument_from(given: StudyFile) -> Instrument | None:
    """Return the instrument of a study's file; None where it names none.

    Raises
    ------
    InputError
        When it shares what is no effect of the instrument, has several sets of recordings, or names a prior that is
        missing, damaged, of another instrument, without one of the shared effects, or made with the help of the study.
    """
    section = given.instrument
    if section is None:
        return None
    for key in known(section.shares, "instrument.shares"):
        if not MECHANISMS[key].may_be_shared:
            shared = ", ".join(key for key, each in MECHANISMS.items() if each.may_be_shared)
            problem = f"{MECHANISMS[key].title} has no value that every test on the instrument shares"
            raise InputError(problem, remedy=f"use some of: {shared}", place="instrument.shares")
    if len(given.recordings) > 1:
        problem, remedy = "the study has several sets of recordings", "give each set a study of its own"
        raise InputError(problem, remedy=remedy, place="instrument")
    if section.prior is None:
        return Instrument(section.name, tuple(section.shares))
    with part_of("instrument.prior"):
        return _with_prior(given, section, section.prior)


def _with_prior(given: StudyFile, section: InstrumentSection, named: str) -> Instrument:
    """Return the instrument with the prior that is `named`; raises `InputError`."""
    if named == given.study:
        raise InputError("a study cannot be its own prior", remedy="name another study, or leave it out")
    file = Path(named).expanduser() if named.endswith(ENDING) else instrument_file(named)
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
        prior = read_prior(record, section.shares)
    except FileNotFoundError:
        make = "give its path" if named.endswith(ENDING) else f"run the study first: palpate run {named}.yaml"
        raise InputError(f"{file} is missing", remedy=make) from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{file} does not hold what a study finds of an instrument", remedy="make it again") from None
    for each in _chain(record):
        if each["study"] == given.study:
            problem = f"{record['study']} rests on {given.study}"
            raise InputError(problem, remedy="let one of the two studies do without the other")
    if record["name"] != section.name:
        problem = f"{record['study']} was made on {record['name']}, this study names {section.name}"
        raise InputError(problem, remedy="name a study on the same instrument")
    if lacks := [key for key in section.shares if key not in record["shares"]]:
        remedy = f"use some of: {', '.join(record['shares'])}"
        raise InputError(f"{record['study']} does not share {lacks[0]}", remedy=remedy)
    if stated := [key for key in section.shares if key in given.diagnosis.ranges]:
        problem = f"{stated[0]} has the ranges of its prior, and others under diagnosis.ranges"
        raise InputError(problem, remedy="leave those out")
    return Instrument(section.name, tuple(section.shares), file, record, prior)


def _chain(record: Mapping[str, Any] | None) -> Iterator[Mapping[str, Any]]:
    """Yield a record, that of its prior, and so on."""
    while record:
        yield record
        record = record["prior"]


def read_prior(record: Mapping[str, Any], shares: Iterable[str]) -> InstrumentPrior:
    """Return what a record says of some mechanisms, whatever others it holds."""
    keys = frozenset(shares)
    ranges: dict[str, dict[str, SearchedRange]] = {}
    for row in record["quantities"]:
        key, name = row["name"].split(".")
        if key in keys:
            ranges.setdefault(key, {})[name] = SearchedRange(row["lower"], row["upper"], row["typical"])
    sets = [(frozenset(row["mechanisms"]), row["probability"], _amplitudes(row)) for row in record["sets"]]
    return InstrumentPrior(record["study"], ranges, *pooled_by_shared(sets, keys))


def _amplitudes(row: Mapping[str, Any]) -> JointAmplitudes | None:
    """Return the density of the amplitudes of a set in a record; None where it has none."""
    if "mean" not in row:
        return None
    return JointAmplitudes(tuple(row["quantities"]), np.array(row["mean"]), np.array(row["covariance"]))
