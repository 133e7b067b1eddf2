"""What a recording shows by itself, before any model: contact, segments, and drift in its hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from indentation_files.contact_point import ContactPoint, first_touch
from indentation_files.drift_rate import DriftRate, fastest_in, measured_in
from indentation_files.errors import InputError
from indentation_files.recording import Recording
from indentation_files.segments import Segment, segments
from indentation_files.sharp_origin import sharp_origin


@dataclass(frozen=True, eq=False)
class Survey:
    """A recording, whole with its approach, and what was found in it.

    The `contact` is that of first touch. `origin` is the depth where a sharp tip's law begins, with its interval [nm].
    `parts` are segments in the order of time; the approach is what surely lies before contact. `drift` is None without
    a drift hold.
    """

    recording: Recording
    contact: ContactPoint
    origin: tuple[float, float, float]
    parts: list[Segment]
    drift: DriftRate | None

    @property
    def load(self) -> np.ndarray:
        """Load (n,) beyond that at contact [mN]."""
        return self.recording.load - self.contact.load

    @cached_property
    def fastest(self) -> tuple[float, float] | None:
        """What its holds under load bound the drift by, see `indentation_files.drift_rate.fastest_in`."""
        return fastest_in(self.recording.time, self.load, self.recording.depth, self.parts)


def survey(recording: Recording) -> Survey:
    """Find contact, segments and drift; raises `InputError` on a recording too short for it."""
    time, load, depth = recording.time, recording.load, recording.depth
    contact = first_touch(time, load, depth)
    beyond = slice(contact.index, None)
    origin = sharp_origin(load[beyond] - contact.load, depth[beyond])
    surely = np.flatnonzero(depth[: contact.index + 1] <= contact.lower)
    parts = segments(time, load - contact.load, int(surely[-1]) if len(surely) else 0)
    return Survey(recording, contact, origin, parts, measured_in(time, depth, parts))


def survey_each(recordings: Sequence[Recording]) -> list[Survey | InputError]:
    """Return what each recording shows, or why it cannot be surveyed; raises the first `InputError` when none can."""
    found: list[Survey | InputError] = []
    for recording in recordings:
        try:
            found.append(survey(recording))
        except InputError as error:
            found.append(error.located(place=recording.name))
    wrong = [item for item in found if isinstance(item, InputError)]
    if wrong and len(wrong) == len(found):
        raise wrong[0]
    return found


def table(surveys: Iterable[Survey], taken: Iterable[tuple[str, float]]) -> pd.DataFrame:
    """Return one row a recording: contact, origin and drift with intervals, and the segments' durations.

    For each of them, `taken` says whose decision its contact is, and its depth [nm].
    """
    rows = []
    for item, (decider, depth) in zip(surveys, taken, strict=True):
        row = {
            "test": item.recording.name,
            "points": len(item.recording),
            "max_load_mN": item.load.max(),
            "contact_time_s": item.contact.time,
            "contact_nm": item.contact.depth,
            "contact_lower_nm": item.contact.lower,
            "contact_upper_nm": item.contact.upper,
        }
        row |= {"contact_taken_nm": depth, "contact_taken_by": decider}
        row |= dict(zip(("origin_nm", "origin_lower_nm", "origin_upper_nm"), item.origin, strict=True))
        drift = (item.drift.rate, item.drift.lower, item.drift.upper) if item.drift else (np.nan,) * 3
        row |= dict(zip(("drift_nm_per_s", "drift_lower_nm_per_s", "drift_upper_nm_per_s"), drift, strict=True))
        row["segments"] = "; ".join(f"{part.kind} {part.start:.4g} to {part.end:.4g} s" for part in item.parts)
        rows.append(row)
    return pd.DataFrame(rows)
