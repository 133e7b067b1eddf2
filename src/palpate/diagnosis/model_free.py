"""Facts about a study's recordings that need no model of the material, each with an interval and what it suggests.

They come before any fit, and hold whatever the material's law is. None of them is a verdict: one in twenty of the
intervals misses the truth by chance, and several mechanisms move each of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from indentation_files.recording import Recording
from indentation_files.reversal_lag import reversal_lag
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.diagnosis import replicate_facts, scaling_facts
from palpate.diagnosis.constraints import is_creeping, law_of_reference, laws_of
from palpate.diagnosis.fact import Fact
from palpate.mechanisms import MECHANISMS

TITLES = {
    "thermal_drift": "rate of the depth in holds at low load, creep and recovery included",
    "frame_compliance": "compliance in series, from unloadings within a test",
}


def model_free(
    study: Study, recorded: Mapping[str, Sequence[Recording]], observed: Mapping[str, Observation]
) -> list[Fact]:
    """Return what the tests of a study that take part in its calibration show without a model.

    They are the recordings of each condition, `recorded` from contact on, and `observed` at the samples of the study.
    """
    tests = [(c, recorded[c.name]) for c in study.calibrated if c.observable.is_depth]
    every = [recording for _, recordings in tests for recording in recordings]
    found = []
    if lag := reversal_lag(every):
        text = "lag of the depth behind the load at corners of its history"
        found.append(Fact(text, lag.lag, lag.lower, lag.upper, "s", ("controller_lag",)))
    found += _exact(study, every, [test for c, each in tests if not c.tip for test in each])
    for name, conditions in study.by_tip(c for c, _ in tests).items():
        if study.tip_of(conditions[0]).sharp:
            alike = [(c, recorded[c.name]) for c in conditions]
            facts = scaling_facts.facts(alike, study.calibration.site_scatter, is_creeping(study))
            found += [fact.under_tip(name) for fact in facts]
    found += replicate_facts.differences({c.name: observed[c.name] for c, _ in tests})
    found += replicate_facts.trend(tests)
    return [fact for fact in found if np.isfinite([fact.estimate, fact.lower, fact.upper]).all()]


def _exact(study: Study, recordings: Sequence[Recording], own: Sequence[Recording]) -> list[Fact]:
    """Return drift and compliance by exact laws, as they appear: the contribution of creep is not subtracted.

    A reference is pressed by the study's `own` tip.
    """
    found = []
    for law in [*laws_of(recordings), *law_of_reference(own, study)]:
        (unit,) = (p.unit for p in MECHANISMS[law.key].parameters if p.name == law.parameter)
        text, background = f"{TITLES[law.key]} ({law.source})", MECHANISMS[law.key].background
        interval = law.estimate, law.lower, law.upper
        found.append(Fact(text, *interval, unit, (law.key, *law.void_with), 0.0, background))
    return found
