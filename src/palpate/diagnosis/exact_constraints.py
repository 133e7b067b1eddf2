"""Exact laws about a study's recordings, corrected for the creep of the solid.

A solid creeps in a hold at low load, which resembles drift, and at the top of an unloading, which resembles a compliant
frame. So the laws are applied to the base model's curves as if these had been recorded: what they give there is the
contribution of creep.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.diagnosis.constraints import law_of_reference, laws_of
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.explanation import Fit
from palpate.materials.flow.row import creeps
from palpate.solver.simulation import simulate_batch
from palpate.solver.study_scale import middle

MOST_POINTS = 400  # samples of a simulation that stands for a recording


class ExactLaws:
    """Amplitudes that exact laws give for one set of recordings, less the contribution of creep.

    Parameters
    ----------
    recorded
        Recordings of every condition under load control; under displacement control these laws do not apply.
    """

    def __init__(self, study: Study, recorded: Mapping[str, Sequence[Recording]]):
        self._study, self._recorded = study, recorded
        material = study.specification(middle(study), study.conditions[0])
        self._creeps = creeps(material.specimen.coefficients)
        self._solid: dict[str, Recording] = {}

    def beside(self, base: Fit) -> list[AmplitudeConstraint]:
        """Return the amplitudes from all recordings that take part in a fit of the base model."""
        names = [condition.name for condition in base.problem.conditions if condition.name in self._recorded]
        if not names:
            return []
        every = [recording for name in names for recording in self._recorded[name]]
        found = laws_of(every)
        if self._creeps and any(np.isfinite(law.lower) for law in found):
            self._solid = undisturbed(base, self._recorded)
            alone = [self._alone(name) * len(self._recorded[name]) for name in names]
            found = laws_of(every, chain.from_iterable(alone))
        with_own = [each.name for each in base.problem.conditions if each.name in names and not each.tip]
        own = [recording for name in with_own for recording in self._recorded[name]]
        return [*found, *law_of_reference(own, self._study)]

    def of_each(self) -> dict[str, list[list[AmplitudeConstraint]]]:
        """Return the amplitudes from each single recording, by condition; call `beside` first."""
        return {
            name: [laws_of([test], self._alone(name) if self._creeps else None) for test in tests]
            for name, tests in self._recorded.items()
        }

    def _alone(self, name: str) -> list[Recording]:
        return [self._solid[name]] if name in self._solid else []


def undisturbed(base: Fit, recorded: Mapping[str, Sequence[Recording]]) -> dict[str, Recording]:
    """Return what would be recorded without any effect, by condition; without those where the model fails.

    Parameters
    ----------
    base
        A fit of the base model; the conditions that take part in it are simulated.
    recorded
        Recordings of each condition; the first says when points are taken, of which there are at most 400.
    """
    conditions = [_sampled_as(c, recorded[c.name][0]) for c in base.problem.conditions if c.name in recorded]
    outcomes = simulate_batch(base.problem.forward.specification(base.z, condition) for condition in conditions)
    return {
        condition.name: Recording(outcome.time, outcome.load, outcome.depth, condition.name)
        for condition, outcome in zip(conditions, outcomes, strict=True)
        if outcome.status == "ok"
    }


def _sampled_as(condition: Condition, recording: Recording) -> Condition:
    times = recording.time[(recording.time > 0.0) & (recording.time <= condition.protocol.knot_time[-1])]
    taken = np.unique(np.linspace(0, len(times) - 1, min(len(times), MOST_POINTS)).round().astype(int))
    return replace(condition, protocol=replace(condition.protocol, sample_time=times[taken]))
