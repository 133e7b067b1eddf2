"""Which mechanisms a diagnosis of a study considers, and within which ranges."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

from palpate.configuration.study_file import Study
from palpate.design.sampling import factorial
from palpate.errors import InputError, located_in
from palpate.mechanisms import MECHANISMS, Mechanism, Scale, considered
from palpate.models.coordinates import Coordinate
from palpate.solver.axisymmetric.contact_size import check_size, contact_range, mean_pressure
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS
from palpate.solver.study_scale import SLOPE, scale_of
from palpate.solver.variation import applied_to_body
from palpate.study.specification import of_equivalent_cone

SOME = 0.6  # of the ranges, where a mechanism is tried on the study's material and tip
KINDS_OF_TESTS = 3  # of what an explanation leaves: each p-value of draws counts so often (Bonferroni)


def candidates(study: Study) -> dict[str, Mechanism]:
    """Return the mechanisms that a diagnosis of the study considers: those that can act on its material and tip.

    Raises
    ------
    InputError
        When the study names a mechanism that does not exist or, beside a stated law, cannot act, shares one that is
        not considered, states a range of a quantity that is not searched, or too few draws.
    """
    found, place = {}, "diagnosis.mechanisms"
    with located_in(study.file):
        wanted = considered(study.diagnosis.mechanisms, place, study.tips)
        tests = {(condition.tip, condition.protocol.control): condition for condition in study.calibrated}
        specifications, scale = [study.specification(study.cells[0], test) for test in tests.values()], scale_of(study)
        _check_draws(study.diagnosis.bootstrap, study.diagnosis.significance)
        _check_ranges(scale, list(wanted))
        for key in scale.stated:
            _check_ends(study, scale, MECHANISMS[key])
        for key, mechanism in wanted.items():
            ranges = mechanism.searched(scale).items()
            some = {name: float(Coordinate.of_amplitude(mechanism, name, r).physical(SOME)) for name, r in ranges}
            values = dict(mechanism.from_search(some, scale))
            try:
                if not any(mechanism.acts_under(specification.tip) for specification in specifications):
                    raise InputError(f"{key}: no calibrate condition has its tip", remedy="leave it out", place=place)
                for specification in specifications:
                    applied_to_body(replace(specification, mechanisms={key: values}))
            except InputError:
                if study.diagnosis.mechanisms and not study.family:
                    raise
                continue
            found[key] = mechanism
        for key in study.instrument.shares if study.instrument else ():
            if key not in found:
                remedy = f"share some of those that the diagnosis considers: {', '.join(found)}"
                raise InputError(f"{key} is not considered", remedy=remedy, place="instrument.shares")
    return found


def _check_draws(draws: int, level: float) -> None:
    """Refuse so few draws that no p-value can fall below the significance: everything would be adequate."""
    least = int(KINDS_OF_TESTS / level + 1e-9)
    if draws < least:
        raise InputError(
            f"{draws} draws cannot show a misfit at a significance of {level:g}",
            remedy=f"draw {least} or more",
            place="diagnosis.bootstrap",
        )


def _check_ranges(scale: Scale, considered: Sequence[str]) -> None:
    """Refuse stated ranges of quantities that are not searched, and empty ranges."""
    for key, ranges in scale.stated.items():
        if key not in considered:
            raise InputError(
                f"mechanism {key!r} is not considered",
                remedy=f"use one of: {', '.join(considered)}",
                place="diagnosis.ranges",
            )
        plausible = MECHANISMS[key].plausible(scale)
        for name, (lower, upper) in ranges.items():
            place = f"diagnosis.ranges.{key}"
            if name not in plausible:
                raise InputError(f"{name} is not searched", remedy=f"use one of: {', '.join(plausible)}", place=place)
            positive = plausible[name].log
            if lower >= upper or (positive and lower <= 0.0):
                remedy = f"give a lower and an upper value{', both positive' if positive else ''}"
                raise InputError(f"{name}: [{lower:g}, {upper:g}] is no range", remedy=remedy, place=place)


def _check_ends(study: Study, scale: Scale, mechanism: Mechanism) -> None:
    """Refuse stated ranges with ends that the mechanism does not allow, or that the study's extreme bodies cannot have.

    Quantities without a stated range are at their lowest, where bodies are softest.
    """
    tests = sorted(study.calibrated, key=lambda condition: -condition.protocol.largest_drive)
    specifications = [of_equivalent_cone(study.specification(cell, test)) for cell in extremes(study) for test in tests]
    ranges, stated = mechanism.searched(scale), scale.stated[mechanism.key]
    ends = [(r.lower, r.upper) if name in stated else (r.lower,) for name, r in ranges.items()]
    for searched in itertools.product(*ends):
        values = dict(mechanism.from_search(dict(zip(ranges, searched, strict=True)), scale))
        try:
            mechanism.check(values)
            for specification in specifications if mechanism.acts_on_body else ():
                solid = mechanism.applied(specification, values)
                largest = contact_range(solid.specimen, solid.indenter, solid.protocol)[1]
                check_size(solid.specimen, solid.indenter, RESOLUTIONS[solid.accuracy], largest)
        except InputError as error:
            place = f"diagnosis.ranges.{mechanism.key}"
            raise InputError(error.problem, remedy=error.remedy, place=place) from None


def extremes(study: Study) -> list[dict[str, float]]:
    """Return the softest and the hardest material among the corners of the study's grid."""
    corners = factorial({name: tuple(sorted({min(levels), max(levels)})) for name, levels in study.levels.items()})
    longest = max(float(condition.protocol.knot_time[-1]) for condition in study.conditions)

    def pressure(cell: Mapping[str, float]) -> float:
        return mean_pressure(study.specification(cell, study.conditions[0]).coefficients, SLOPE, longest)

    return [min(corners, key=pressure), max(corners, key=pressure)]
