"""Which simulations show what each mechanism does: paired runs with and without it, over material and amplitude.

The points are a Sobol sequence over the grid's parameters and the mechanism's search ranges together. Every mechanism
uses the same materials, so each material is simulated once without any. Since only the difference of the two curves is
kept, a third of the points in time is enough.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from palpate.config import Condition, Study
from palpate.design import factorial
from palpate.errors import InputError
from palpate.fem.contact_size import check_size, contact_range, expected_load, mean_pressure
from palpate.fem.discretisation import RESOLUTIONS
from palpate.fem.profile import Profile
from palpate.inference.forward import kept
from palpate.mechanisms import MECHANISMS, Mechanism, Scale
from palpate.protocol import DISPLACEMENT, LOAD, Protocol
from palpate.snapshots import Batch, Snapshot, conditions_by_shape, divided
from palpate.variation import acting

SMALL = {LOAD: 0.2, DISPLACEMENT: 0.45}  # of the largest drive: a sharp tip carries a fifth of the load there
PAIRS_FOR_EACH = 3  # of the parameters of an effect, from which it can be learnt
MOST_COORDINATES = 3
KINDS_OF_TESTS = 3  # of what an explanation leaves: each p-value of draws counts so often (Bonferroni)
SLOPE = 0.36  # of a Berkovich pyramid's equivalent cone, at which materials are compared


@dataclass(frozen=True, eq=False)
class Pair:
    """One material, simulated with and without a mechanism.

    Parameters
    ----------
    cell
        Material parameters.
    coordinates : ndarray, shape (k,)
        Position in the mechanism's search ranges, each in [0, 1].
    plain, acting
        The two snapshots.
    """

    cell: Mapping[str, float]
    coordinates: np.ndarray
    plain: Snapshot
    acting: Snapshot


def middle(study: Study) -> dict[str, float]:
    """Return the material in the middle of the study's grid."""
    return {name: float(np.mean(levels)) for name, levels in study.levels.items()}


def scale_of(study: Study) -> Scale:
    """Return the size of the study, estimated from its middle material."""
    cell = middle(study)
    conditions = [condition for condition in study.conditions if condition.role == "calibrate"]
    largest = max(conditions, key=lambda condition: condition.protocol.largest_drive)
    specification = study.specification(cell, largest)
    radius = contact_range(specification.specimen, study.indenter, largest.protocol)[1]
    tip = study.indenter
    slope = Profile.of(tip).slope_for(radius) if tip.area else tip.slope
    slope = slope if np.isfinite(slope) else radius / (1e-3 * tip.radius)
    return Scale(
        depth=1.2e3 * radius * slope,
        load=expected_load(specification.specimen, study.indenter, largest.protocol),
        modulus=specification.parameters["youngs_modulus"],
        duration=max(float(c.protocol.sample_time[-1]) for c in conditions),
        loading_time=min(longest_rise(c.protocol) for c in conditions),
        half_angle=study.indenter.half_angle,
        pressure=mean_pressure(specification.coefficients, slope, 0.6 * float(largest.protocol.knot_time[-1])),
        stated=study.diagnosis["ranges"],
    )


def longest_rise(protocol: Protocol) -> float:
    """Return the duration [s] of the uninterrupted rise that gains the most, however many corners it has."""
    steps = np.diff(protocol.knot_drive)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], steps > 0, [False]]).astype(int)))
    runs = ends.reshape(-1, 2)
    first, last = max(runs, key=lambda run: protocol.knot_drive[run[1]] - protocol.knot_drive[run[0]])
    return float(protocol.knot_time[last] - protocol.knot_time[first])


def candidates(study: Study) -> dict[str, Mechanism]:
    """Return the mechanisms that a diagnosis of the study considers: those that can act on its material and tip.

    Raises
    ------
    InputError
        When the study names what is not known or cannot act, ranges of what is not searched, or too few draws.
    """
    try:
        return _candidates(study)
    except InputError as error:
        raise error.located(file=study.file) from None


def _candidates(study: Study) -> dict[str, Mechanism]:
    wanted = study.diagnosis["mechanisms"] or list(MECHANISMS)
    tests = {condition.protocol.control: condition for condition in study.conditions if condition.role == "calibrate"}
    specifications, scale = [study.specification(study.cells[0], test) for test in tests.values()], scale_of(study)
    _check_draws(study.diagnosis["bootstrap"], study.diagnosis["significance"])
    _check_ranges(scale, [key for key in wanted if key in MECHANISMS])
    for key in scale.stated:
        _check_ends(study, scale, MECHANISMS[key])
    found = {}
    for key in wanted:
        if key not in MECHANISMS:
            raise InputError(
                f"mechanism {key!r} is not known",
                remedy=f"use one of: {', '.join(MECHANISMS)}",
                place="diagnosis.mechanisms",
            )
        mechanism = MECHANISMS[key]
        values = amplitudes(mechanism, scale, np.full(mechanism_dimensions(mechanism, scale), 0.6))
        try:
            for specification in specifications:
                acting(replace(specification, mechanisms={key: values}))
        except InputError:
            if study.diagnosis["mechanisms"]:
                raise
            continue
        found[key] = mechanism
    return found


def _check_draws(draws: int, level: float) -> None:
    """Refuse so few draws of the noise that no p-value falls below the significance: everything would pass."""
    least = int(KINDS_OF_TESTS / level + 1e-9)
    if draws < least:
        raise InputError(
            f"{draws} draws cannot show a misfit at a significance of {level:g}",
            remedy=f"draw {least} or more",
            place="diagnosis.bootstrap",
        )


def _check_ranges(scale: Scale, considered: Sequence[str]) -> None:
    """Refuse stated ranges of what is not searched, or that hold nothing."""
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
    """Refuse stated ranges whose ends the mechanism does not declare, or the study's extreme bodies cannot have.

    Quantities without a stated range are at their lowest, where bodies are softest.
    """
    tests = [condition for condition in study.conditions if condition.role == "calibrate"]
    tests.sort(key=lambda condition: -condition.protocol.largest_drive)
    specifications = [study.specification(cell, test) for cell in extremes(study) for test in tests]
    ranges, stated = mechanism.searched(scale), scale.stated[mechanism.key]
    ends = [(r.lower, r.upper) if name in stated else (r.lower,) for name, r in ranges.items()]
    for searched in itertools.product(*ends):
        values = dict(mechanism.from_search(dict(zip(ranges, searched, strict=True)), scale))
        try:
            mechanism.check(values)
            for specification in specifications if mechanism.needs_learning else ():
                solid = mechanism.simulate(specification, values)
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


def mechanism_dimensions(mechanism: Mechanism, scale: Scale) -> int:
    """Return the number of coordinates in which a mechanism is searched."""
    return len(mechanism.searched(scale))


def amplitudes(mechanism: Mechanism, scale: Scale, coordinates: np.ndarray) -> dict[str, float]:
    """Return a mechanism's parameters at coordinates (k,) of its search ranges."""
    ranges = mechanism.searched(scale)
    searched = {name: float(r.physical(x)) for (name, r), x in zip(ranges.items(), coordinates, strict=True)}
    return dict(mechanism.from_search(searched, scale))


def thinned(protocol: Protocol) -> Protocol:
    """Return the protocol with every third sample; those at corners of the history and at small loads are kept.

    At small loads, where depth goes with the root of the load, most effects change fastest.
    """
    keep = kept(protocol) | (protocol.sample_drive < SMALL[protocol.control] * protocol.largest_drive)
    return replace(protocol, sample_time=protocol.sample_time[keep])


def pairs(study: Study, condition: Condition, key: str) -> list[Pair]:
    """Return the paired simulations of one mechanism under one condition; none where it only adds to a depth."""
    mechanism, scale = MECHANISMS[key], scale_of(study)
    if not mechanism.learnt_under(condition.protocol.control):
        return []
    free = study.free_parameters
    dimensions = mechanism_dimensions(mechanism, scale)
    count = study.diagnosis["snapshots"] * (1 + dimensions) // 2
    sequence = qmc.Sobol(len(free) + MOST_COORDINATES, seed=study.seed)
    points = sequence.random_base2(int(np.ceil(np.log2(count))))[:count]
    short = replace(condition, protocol=thinned(condition.protocol))
    cells = []
    for point in points:
        cell = {name: levels[0] for name, levels in study.levels.items()}
        for name, x in zip(free, point, strict=False):
            low, high = min(study.levels[name]), max(study.levels[name])
            cell[name] = float(low + x * (high - low))
        cells.append(cell)
    made = []
    for cell, point in zip(cells, points, strict=True):
        coordinates = point[len(free) : len(free) + dimensions]
        plain = study.specification(cell, short)
        disturbed = replace(plain, mechanisms={key: amplitudes(mechanism, scale, coordinates)})
        made.append(
            Pair(cell, coordinates, Snapshot(cell, condition.name, plain), Snapshot(cell, condition.name, disturbed))
        )
    return made


def refinement(study: Study, condition: Condition) -> tuple[Snapshot, Snapshot]:
    """Return the study's middle material under one condition, as the snapshots are simulated and at `accuracy: fine`.

    Their ratio is the error of the mesh, which hardly depends on the material.
    """
    cell = middle(study)
    usual, fine = (study.specification(cell, condition, accuracy) for accuracy in ("standard", "fine"))
    return Snapshot(cell, condition.name, usual), Snapshot(cell, condition.name, fine)


def plan(study: Study, results: Path = Path("results")) -> list[Batch]:
    """Divide the simulations that a diagnosis needs into jobs; conditions that differ in size alone share theirs."""
    batches, keys = [], list(candidates(study))
    for conditions in conditions_by_shape(study):
        found = [
            snapshot for same in zip(*(needed(study, c, keys) for c in conditions), strict=True) for snapshot in same
        ]
        members = list({snapshot.address: snapshot for snapshot in found}.values())
        folder = results / study.name / "effects"
        per_job = study.cells_per_job * len(conditions)
        batches += divided(f"effects_{conditions[0].name}", members, folder, per_job)
    return batches


def needed(study: Study, condition: Condition, keys: Sequence[str]) -> list[Snapshot]:
    """Return what is simulated under one condition to learn what mechanisms do; some more than once."""
    snapshots = list(refinement(study, condition))
    for key in keys:
        for pair in pairs(study, condition, key):
            snapshots += [pair.plain, pair.acting]
    return snapshots
