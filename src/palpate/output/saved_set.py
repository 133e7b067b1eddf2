"""The results of one set of recordings as files hold them; figures and result objects are made of these alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from indentation_files.recording import Recording
from palpate.base.parameters import Parameter
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.mechanisms import MECHANISMS

ALL = "all"  # the condition set of every calibrated condition


@dataclass(frozen=True, eq=False)
class SavedSet:
    """Results of one set of recordings.

    Parameters
    ----------
    study
        The study.
    name
        Of the set.
    tests
        Recordings of each condition, from contact on.
    calibrations
        Content of the calibration of each condition set, `ALL` first.
    fits
        Curves of each of them, see `palpate.workflow_support.steps.run_calibration`.
    diagnosis
        Content of ``diagnosis.json``, where the recordings were diagnosed.
    explained
        Recorded curves beside those of the base model (before) and of the best explanation (after), of a diagnosis.
    surrogates
        Summary of the surrogate of each calibrated condition.
    truth
        Parameters that a virtual laboratory took, by name.
    """

    study: Study
    name: str
    tests: Mapping[str, Sequence[Recording]]
    calibrations: Mapping[str, Mapping[str, Any]]
    fits: Mapping[str, pd.DataFrame]
    diagnosis: Mapping[str, Any] | None = None
    explained: pd.DataFrame | None = None
    surrogates: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    truth: Mapping[str, float] = field(default_factory=dict)

    @property
    def synthetic(self) -> bool:
        """Whether any test was simulated, and not measured."""
        return any(test.synthetic for tests in self.tests.values() for test in tests)

    @property
    def accepted(self) -> Sequence[Mapping[str, Any]]:
        """The explanations that a diagnosis accepted, best first; none where the base model is adequate."""
        return self.diagnosis["candidates"] if self.diagnosis else ()

    @property
    def labels(self) -> dict[str, str]:
        """What people call the conditions, by name."""
        return labels(self.study)

    def quantity(self, name: str) -> Parameter:
        """Return what is declared of a material parameter, or of a mechanism's, as ``key.name``."""
        if "." not in name:
            return self.study.declared[name]
        key, own = name.split(".")
        return next(parameter for parameter in MECHANISMS[key].parameters if parameter.name == own)


def labels(study: Study) -> dict[str, str]:
    """Return what people call the conditions of a study by name, such as ``1 mN, 30 s``; its name where two agree."""
    found = {condition.name: _label(condition) for condition in study.conditions}
    every = list(found.values())
    return {name: label if every.count(label) == 1 else name for name, label in found.items()}


def _label(condition: Condition) -> str:
    """Return largest drive, durations of loading and hold, and a tip's name; the name where the load was recorded."""
    protocol = condition.protocol
    if condition.follows or condition.own_loads or not 3 <= len(protocol.knot_time) <= 4:
        return condition.name
    times = protocol.knot_time
    hold = f", hold {times[2] - times[1]:g} s" if len(times) == 4 and times[2] - times[1] > 0 else ""
    tip = f", {condition.tip}" if condition.tip else ""
    return f"{protocol.largest_drive:g} {protocol.unit}, {times[1]:g} s{hold}{tip}"
