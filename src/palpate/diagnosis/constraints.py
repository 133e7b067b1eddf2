"""Amplitudes that exact laws give without any model of the tip, and whether an explanation agrees with them.

A hold at low load shows the drift. Unloadings from several loads within a test, or the stiffness measured by an
oscillation while the load grows, show the frame; so does one unloading of a solid of known modulus. A hold at any load
bounds the drift, because creep only adds to the depth.

Creep resembles drift in a hold at low load, and a compliant frame at the top of an unloading. So the first two laws are
applied to the base model's curves as if these had been recorded, and what they give there is subtracted.

Laws are data beside the curves (`palpate.inference.amplitude_constraint`) as long as the two agree: an explanation
whose amplitude from the curves alone lies outside both intervals is rejected, however well it fits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import chain
from typing import Any

import numpy as np

from indentation_files.recording import Recording
from indentation_files.sharp_origin import sharp_origin
from indentation_files.survey import Survey, survey
from palpate.classical.frame import FrameCompliance, frame_by_oscillation, frame_of
from palpate.classical.reference_sample import ReferenceSample, frame_of_reference
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.errors import InputError
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.inference.explanation import Fit
from palpate.materials.flow.row import creeps
from palpate.mechanisms import MECHANISMS, Assumption, breaking
from palpate.solver.simulation import simulate_batch
from palpate.solver.study_scale import middle
from palpate.study.area_function import AreaFunction

DRIFT, FRAME = ("thermal_drift", "rate"), ("frame_compliance", "compliance")  # amplitudes that exact laws give
MOST_POINTS = 400  # samples of a simulation that stands for a recording
OF_HOLDS = (Assumption.ALL_CREEP_IS_KNOWN, Assumption.STEADY_DRIFT)
OF_TOPS = (Assumption.UNIFORM, Assumption.RECORDED_LOAD_ACTS, Assumption.ONE_COMPLIANCE)
OF_OSCILLATION = (Assumption.UNIFORM, Assumption.ONE_COMPLIANCE)


@lru_cache(maxsize=256)
def surveyed(recording: Recording) -> Survey | None:
    """Survey a recording (cached: its study's laws and its own need it); None where it cannot be surveyed."""
    try:
        return survey(recording)
    except InputError:
        return None


def laws_of(recordings: Iterable[Recording], solid: Iterable[Recording] | None = None) -> list[AmplitudeConstraint]:
    """Return the amplitudes that exact laws give from recordings of one material on one instrument; may be empty.

    The drift is the mean of the tests' rates, with the mean of their intervals: each test has a rate of its own. Where
    no test holds a low load, holds under load bound the drift. For the frame, tests with four unloadings whose loads
    span a factor of three are taken together.

    Parameters
    ----------
    solid
        For a solid that creeps: what would be recorded without any effect, see `undisturbed`.
        The apparent drift and compliance of these curves are subtracted, and widen the intervals by as much on both
        sides, since they are known no better than the material; where these curves give none, the laws do not apply.
    """
    seen = [found for found in map(surveyed, recordings) if found is not None]
    alone = None if solid is None else [found for found in map(surveyed, solid) if found is not None]
    laws = []
    if drift := _less_creep(_drift_in_holds, seen, alone):
        laws.append(drift)
    elif fastest := [found.fastest for found in seen if found.fastest]:
        rate, upper = np.mean(fastest, axis=0).tolist()
        source = f"no faster than late in holds, {len(fastest)}"
        laws.append(AmplitudeConstraint(*DRIFT, rate, -np.inf, upper, source, breaking(Assumption.STEADY_DRIFT)))
    return laws + [law for law in (_less_creep(_frame_by_tops, seen, alone), _frame_by_oscillation(seen)) if law]


def _less_creep(
    measure: Callable[[Sequence[Survey]], AmplitudeConstraint | None],
    seen: Sequence[Survey],
    alone: Sequence[Survey] | None,
) -> AmplitudeConstraint | None:
    """Return what a law gives, less what it gives for the curves of the creeping solid without any effect."""
    found = measure(seen)
    if found is None or alone is None:
        return found
    own = measure(alone)
    if own is None:
        return None
    value, slack = own.estimate, abs(own.estimate)
    return replace(
        found, estimate=found.estimate - value, lower=found.lower - value - slack, upper=found.upper - value + slack
    )


def _drift_in_holds(seen: Sequence[Survey]) -> AmplitudeConstraint | None:
    drifts = [(found.drift.rate, found.drift.lower, found.drift.upper) for found in seen if found.drift]
    if not drifts:
        return None
    rate, lower, upper = np.mean(drifts, axis=0).tolist()
    source = f"holds at low load, {len(drifts)}"
    return AmplitudeConstraint(*DRIFT, rate, lower, upper, source, breaking(*OF_HOLDS))


def _frame_by_tops(seen: Sequence[Survey]) -> AmplitudeConstraint | None:
    """Return the frame from the tops of unloadings, with each test's drift subtracted where a hold gives it."""
    of_drift = OF_HOLDS if all(found.drift for found in seen) else (*OF_HOLDS, Assumption.NO_DRIFT)
    frame = frame_of([(found.load, _without_drift(found), found.parts) for found in seen])
    return _law_of(frame, "initial slopes of unloadings", OF_TOPS + of_drift) if frame else None


def _without_drift(found: Survey) -> np.ndarray:
    return found.recording.depth - (found.drift.rate * found.recording.time if found.drift else 0.0)


def _frame_by_oscillation(seen: Sequence[Survey]) -> AmplitudeConstraint | None:
    tests = [(found.load, found.recording.stiffness) for found in seen if found.recording.stiffness is not None]
    frame = frame_by_oscillation(tests)
    return _law_of(frame, "stiffness by oscillation, levels of load", OF_OSCILLATION) if frame else None


def law_of_reference(recordings: Iterable[Recording], study: Study) -> list[AmplitudeConstraint]:
    """Return the frame from unloadings where the study's solid and tip are a reference; else an empty list."""
    given = study.diagnosis.reference
    if given is None:
        return []
    solid = (1.0 - given.poisson_ratio**2) / given.youngs_modulus
    reduced = 1.0 / (solid + study.indenter.compliance)
    reference = ReferenceSample(reduced, AreaFunction(tuple(given.area)), given.uncertainty)
    frame = frame_of_reference([(test.load, test.depth) for test in recordings], reference)
    return [_law_of(frame, "unloadings of a solid of known modulus", (Assumption.ONE_COMPLIANCE,))]


def _law_of(frame: FrameCompliance, measured_by: str, assumed: Sequence[Assumption]) -> AmplitudeConstraint:
    interval, source = (frame.compliance, frame.lower, frame.upper), f"{measured_by}, {frame.unloadings}"
    return AmplitudeConstraint(*FRAME, *interval, source, breaking(*assumed))


class ExactLaws:
    """Amplitudes that exact laws give for one set of recordings, less the contribution of creep.

    Parameters
    ----------
    recorded
        Recordings of every condition under load control; under displacement control these laws do not apply.
    """

    def __init__(self, study: Study, recorded: Mapping[str, Sequence[Recording]]):
        self._study, self._recorded = study, recorded
        self._creeps = is_creeping(study)
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


def is_creeping(study: Study) -> bool:
    """Return whether the law of a study creeps."""
    return creeps(study.specification(middle(study), study.conditions[0]).specimen.coefficients)


def undisturbed(base: Fit, recorded: Mapping[str, Sequence[Recording]]) -> dict[str, Recording]:
    """Return what would be recorded without any effect under the conditions that take part in a fit of the base model.

    The first recording of each says when points are taken, at most `MOST_POINTS`. Those where the model fails are left
    out.
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


def zero_points(
    recordings: Mapping[str, Iterable[Recording]], laws: Sequence[AmplitudeConstraint] = ()
) -> list[dict[str, Any]]:
    """Return the zero points of a sharp tip's law, one row a recording: condition, number, estimate, lower, upper [nm].

    A blunt tip, a yielding frame and creep shift the origin, too. Where a law gives the frame (the law with the
    narrowest interval), ``frame_off``, ``frame_off_lower`` and ``frame_off_upper`` are the zero point with that
    compliance subtracted; they cover the law's interval. Differences between tests on one material are free of all
    that.
    """
    shown = [law for law in laws if law.key == FRAME[0] and law.lower * law.upper > 0.0]
    shown = sorted(shown, key=lambda law: law.upper - law.lower)[:1]
    rows = []
    for condition, tests in recordings.items():
        for number, test in enumerate(tests, 1):
            origin = sharp_origin(test.load, test.depth)
            if not np.isfinite(origin[0]):
                continue
            row = {"condition": condition, "number": number}
            rows.append(row | dict(zip(("estimate", "lower", "upper"), origin, strict=True)))
            for law in shown:
                frames = (law.estimate, law.lower, law.upper)
                found = np.array([sharp_origin(test.load, test.depth - frame * test.load) for frame in frames])
                ends = {"frame_off_lower": found[:, 1].min(), "frame_off_upper": found[:, 2].max()}
                rows[-1] |= {"frame_off": float(found[0, 0])} | {name: float(end) for name, end in ends.items()}
    return rows


def contradicted(fit: Fit, laws: Sequence[AmplitudeConstraint]) -> list[AmplitudeConstraint]:
    """Return the laws that an explanation's amplitudes, estimated from the curves alone, contradict."""
    return [law for law in laws if law.holds_under(fit.explanation) and not law.allows(*_amplitude(fit, law))]


def _amplitude(fit: Fit, law: AmplitudeConstraint) -> tuple[float, float]:
    """Return a mechanism's amplitude from the curves alone, and its standard deviation.

    Where laws took part in the fit, their contribution is removed to first order. Without the mechanism the amplitude
    is zero, to within what counts as background.
    """
    if law.key not in fit.explanation:
        return 0.0, MECHANISMS[law.key].background
    problem, z = fit.problem, fit.z
    change, covariance = fit.joined(np.empty((len(fit.curve), 0)), np.empty(0))
    if fit.constraints:
        z = z + change
    value, slope = problem.quantity(fit.explanation, z, law.quantity)
    place = problem.place(fit.explanation, law.quantity)
    return value, slope * float(np.sqrt(covariance[place, place]))
