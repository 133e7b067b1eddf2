"""The limits of a diagnosis: what its recordings cannot show, in sentences."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.configuration.study_file import Study
from palpate.diagnosis.between_tests import p_between_tests
from palpate.diagnosis.candidates import KINDS_OF_TESTS
from palpate.diagnosis.diagnose import DiagnosisOutcome, zero_on_average
from palpate.inference.explanation import Fit
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS, quantity_in_words
from palpate.models.coordinates import Coordinate

SAME_LOAD = 1.01  # ratio of loads within which tests count as equally large
OUTSIDE = 0.005  # of a range, beyond its ends: a parameter is reported as outside


def limits(study: Study, diagnosis: DiagnosisOutcome, failed: Mapping[str, str], rng: np.random.Generator) -> list[str]:
    """Return all limits of a `diagnosis` of a `study`.

    `failed` says why the errors of some conditions are not known, by their names; `rng` gives the draws of
    `follows_tests`.
    """
    return [
        *of_recordings(study, diagnosis.base.fit.problem),
        *(f"{name} could not be fitted: {reason}." for name, reason in diagnosis.failed.items()),
        *(f"{name} is not among the errors shown: {reason}." for name, reason in failed.items()),
        *without_mean(diagnosis),
        *far_out(diagnosis),
        *follows_tests(diagnosis, study.diagnosis.significance, rng),
    ]


def of_recordings(study: Study, problem: Problem) -> list[str]:
    """Return what cannot be known from these recordings, in sentences."""
    count, messages = len(problem.conditions), []
    if not problem.replicated:
        messages.append(
            "At most half of the conditions have replicates: scatter between sites and slow drift are assumed, not "
            "measured, so no effect is identified."
        )
    elif len(problem.repeated) < count:
        messages.append("Some conditions have no replicates: their noise is taken from the others.")
    if count == 1:
        messages.append(
            "There is a single condition: effects of load, rate and time cannot be separated by comparison, so only "
            "effects of the instrument can be identified."
        )
    displaced = not all(condition.observable.is_depth for condition in problem.conditions)
    if displaced:
        messages.append(
            "A displacement is prescribed: misfits are loads, converted to equivalent depths. Exact laws about single "
            "recordings do not apply to such tests, effects on the depth that are not linear in the load are not "
            "considered, and no further test is proposed."
        )
    drives = [condition.protocol.largest_drive for condition in problem.conditions]
    kinds = {condition.protocol.control for condition in problem.conditions}
    tips = {condition.tip for condition in problem.conditions}
    if len(kinds) == len(tips) == 1 and max(drives) < SAME_LOAD * min(drives):
        effects = ", ".join(
            mechanism.title for mechanism in MECHANISMS.values() if mechanism.unidentifiable_at_one_load
        )
        messages.append(
            f"All fitted tests reach the same largest {kinds.pop()}: a change of the material's parameters can have "
            f"the same effect as {effects}."
        )
    if not any(item.role == "validate" for item in problem.observed.values()):
        messages.append("No condition was held out: the improvement cannot be checked on tests that were not fitted.")
    return messages


def without_mean(diagnosis: DiagnosisOutcome) -> list[str]:
    """Return which effects of the most likely accepted explanation may be zero in the mean of the recordings."""
    return [
        f"The mean of {MECHANISMS[key].title} does not differ from zero: it explains that single recordings "
        "differ, and alone would only be suspected."
        for candidate in diagnosis.accepted[:1]
        for key in zero_on_average(candidate.fit)
    ]


def far_out(diagnosis: DiagnosisOutcome) -> list[str]:
    """Return which quantities of the most likely explanation lie outside their ranges."""
    found = outside((diagnosis.accepted or diagnosis.tried)[0].fit)
    if not found:
        return []
    values = [
        f"{quantity_in_words(each.name)} {value:.3g} ({each.lower:.3g} to {each.upper:.3g})" for each, value in found
    ]
    return [
        "At the best point of the closest fit some quantities lie outside the study's plausible ranges (keys "
        f"parameters and diagnosis.ranges), given in parentheses: {', '.join(values)}; the tables give medians."
    ]


def outside(fit: Fit) -> list[tuple[Coordinate, float]]:
    """Return the quantities of an explanation outside their ranges, with their values."""
    coordinates, beyond = fit.coordinates, np.abs(fit.coordinates.beyond(fit.z)) > OUTSIDE
    quantities = zip(coordinates.free, fit.z, beyond, strict=True)
    return [(each, float(each.physical(x))) for each, x, far in quantities if far]


def follows_tests(diagnosis: DiagnosisOutcome, level: float, rng: np.random.Generator) -> list[str]:
    """Return which effect on single recordings depends on the test, where no explanation was accepted."""
    if diagnosis.verdict != "unexplained":
        return []
    found = p_between_tests(diagnosis.tried[0].fit, rng)
    count = KINDS_OF_TESTS * len(found)
    titles = sorted({MECHANISMS[name.split(".")[0]].title for name, p in found.items() if count * p < level})
    if not titles:
        return []
    return [
        f"The most likely explanation that was tried needs another value of {' and '.join(titles)} for each test, "
        "while replicates agree. So this is no effect of single recordings: either the instrument changed between the "
        "tests, or the missing effect depends on the test and is not in the library."
    ]
