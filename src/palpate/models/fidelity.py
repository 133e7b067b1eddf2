"""Levels of fidelity: on which mesh, and at how many samples, a curve of the body is simulated.

| level | mesh | samples | serves |
|---|---|---|---|
| `STUDY` | the study's | all | where a condition has no anchor |
| `SEARCH` | the study's with few sectors | few | searches, scaled to an anchor |
| `COARSE` | the study's | few | to know what the next mesh changes; searches from an anchor on finer meshes |
| `RECORD` | finer by one degree | all | anchors |
| `MEDIUM`, `FINE` | finer by one degree, and by two | few | last steps, Richardson's extrapolation |
| `PYRAMID` | that of the pyramid, in place of the equivalent cone | few | anchors under a pyramid |
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.configuration.condition import Condition
from palpate.study.protocol import Protocol

THINNING = 4  # one of so many samples is kept where curves of another simulation interpolate the rest
FEWEST = 25  # samples that are kept


@dataclass(frozen=True)
class Level:
    """How closely a curve of the body is simulated.

    Parameters
    ----------
    degrees
        By so many degrees the mesh is finer than the study's.
    few_sectors
        Whether it has few sectors of elements between surface and axis.
    few_samples
        Whether few samples are simulated, hence in fewer steps.
    pyramid
        Whether a pyramid is simulated as such, and not as the equivalent cone.
    """

    degrees: int = 0
    few_sectors: bool = False
    few_samples: bool = False
    pyramid: bool = False

    def sampled(self, conditions: Sequence[Condition], all_samples: Collection[str] = ()) -> list[Condition]:
        """Return the conditions with the samples of this level; with all under those of the names given."""
        return [thinned(c) if self.few_samples and c.name not in all_samples else c for c in conditions]


STUDY, RECORD = Level(), Level(degrees=1)
SEARCH = Level(few_sectors=True, few_samples=True)
COARSE, MEDIUM, FINE = (Level(degrees, few_samples=True) for degrees in range(3))
PYRAMID = Level(few_samples=True, pyramid=True)


def thinned(condition: Condition) -> Condition:
    """Return a condition with those samples that are `kept`."""
    protocol = condition.protocol
    return replace(condition, protocol=replace(protocol, sample_time=protocol.sample_time[kept(protocol)]))


def kept(protocol: Protocol) -> np.ndarray:
    """Return which samples (n_points,) suffice for slowly varying curves: a few, corners, the first and last ones.

    Effects change fastest late in unloading, and at the beginning, where the load comes late by as much as it lasts.
    """
    keep = np.isclose(protocol.sample_time[:, None], protocol.knot_time, rtol=1e-9, atol=0.0).any(axis=1)
    every = min(THINNING, max(1, len(keep) // FEWEST))
    keep[::-every] = True
    keep[:3] = keep[-every:] = True
    return keep
