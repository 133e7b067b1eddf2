"""Data quality: anomalies of valid recordings, reported before anything is simulated and left to the user."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from indentation_files.borne_load import pull_off
from indentation_files.channel_noise import MEDIAN
from indentation_files.contact_interval import disagreeing, interval_of, vague
from indentation_files.pop_in import pop_ins
from indentation_files.readers.in_air import air_at_start, suspects
from indentation_files.readers.zero import begins_off_contact
from indentation_files.recording import Recording
from indentation_files.recording_file import other_files
from indentation_files.reversal_lag import reversal_lag
from indentation_files.sentences import and_more
from palpate.classical.joslin_oliver import different_materials
from palpate.configuration.condition import Condition
from palpate.configuration.prescribed_history import RECORDED
from palpate.configuration.study_file import Study
from palpate.study.prescribed_segments import last_cycles
from palpate.study.protocol import LOAD
from palpate.study.recorded_history import averaged_over, swing

MISSTATED = 0.01  # relative error of a stated largest load from which on it is reported: the material would take it up
OF_READ = "`palpate read --contact auto` finds the contact"
APART = 1.5  # ratio of a test's depth to its condition's median beyond which it is reported
CLEARLY_APART = 1.15  # chosen: likewise, where it is beyond the scatter of the others by far
SCATTER = 6.0  # robust standard deviations
FEWEST = 4  # tests that show their scatter
STEPS, GAP = 20.0, 0.05  # median steps, and share of the test's duration: a longer time without points is reported
LEAST_LAG = 0.25  # of a sampling step, chosen: a smaller one changes no depth by more than the points tell
MOST_TESTS = 20  # that are looked at for a lag
LONGER = 1.05  # ratio of durations beyond which the end of a test is reported as ignored


def anomalies(condition: Condition, tests: Sequence[Recording]) -> Iterator[str]:
    """Report the anomalies of the tests of a condition.

    A largest load that the study misstates; tests of another material, much deeper or shallower than the others, that
    begin elsewhere than at contact, or in air, or last longer than the load that is followed; contacts that are vague
    or differ between replicates; jumps of the depth, times without points, a lag of the depth, pulls on the tip, and
    loads that are averaged as they are noisy or oscillate.
    """
    yield from misstated(condition, tests)
    yield from _apart(tests)
    if unlike := different_materials(tests):
        yield unlike
    yield from _off_contact(tests)
    yield from disagreeing(tests)
    yield from vague(tests)
    yield from _jumps(tests)
    yield from _gaps(tests)
    yield from _lagging(tests)
    yield from _pulled(condition, tests)
    yield from _averaged(condition, tests)
    if condition.follows and not condition.own_loads:
        yield from _cut(condition, tests)


def misstated(condition: Condition, tests: Sequence[Recording]) -> Iterator[str]:
    """Report a largest load or displacement, stated by numbers, that lies off those of the tests.

    The steps beside a test's largest value tell how far noise and coarse sampling may have moved it.
    """
    if condition.follows or condition.own_loads:
        return
    protocol = condition.protocol
    drives = [protocol.drive_of(test.load, test.depth) for test in tests]
    steps = [np.abs(drive[max(k - 1, 0) : k + 2] - drive[k]).max() for drive in drives for k in [int(drive.argmax())]]
    peak, step, stated = np.median([drive.max() for drive in drives]), np.median(steps), protocol.largest_drive
    if abs(peak - stated) > MISSTATED * stated + step:
        yield (
            f"the largest {protocol.control} of {condition.name} is {peak:.4g} {protocol.unit} in the median of its "
            f"tests, the study states {stated:.4g} {protocol.unit}: correct it (max_{protocol.control}: {peak:.4g})"
        )


def _apart(tests: Sequence[Recording]) -> Iterator[str]:
    """Report tests that are much deeper or shallower than the others of their condition."""
    depths = np.array([test.depth.max() for test in tests])
    usual = float(np.median(depths))
    off = np.abs(np.log(np.maximum(depths, 1e-12) / max(usual, 1e-12)))
    apart = np.log(APART)
    if len(tests) >= FEWEST:
        apart = min(max(np.log(CLEARLY_APART), SCATTER * float(np.median(off)) / MEDIAN), apart)
    for test, depth, far in zip(tests, depths, off, strict=True):
        if far >= apart:
            yield (
                f"{test.name}.csv is {depth:.4g} nm deep, the median of its condition's tests {usual:.4g} nm: another "
                "unit, zero point or material?"
            )


def _off_contact(tests: Sequence[Recording]) -> Iterator[str]:
    """Report the tests that begin in air, and those that begin elsewhere than at contact."""
    sought = suspects([test for test in tests if interval_of(test) is None])
    if in_air := [(test.name, told[0]) for test in sought if (told := air_at_start(test, OF_READ))]:
        yield f"{in_air[0][0]}.csv{and_more(in_air)}: {in_air[0][1]}"
    if off := list(filter(begins_off_contact, tests)):
        yield (
            f"{off[0].name}.csv{and_more(off)} begin{'' if len(off) > 1 else 's'} at a depth of {off[0].depth[0]:.4g} "
            f"nm, not at contact: all of its depth counts ({OF_READ})"
        )


def cycles_to_hold_out(study: Study) -> Iterator[str]:
    """Propose the last cycles of the first condition that has some for validation."""
    for condition in study.calibrated:
        if last := last_cycles(condition.protocol):
            (begin, end), words = last
            yield f"held_out: [[{begin:.6g}, {end:.6g}]] of {condition.name} would validate on {words}"
            return


def passed_over(folder: Path) -> Iterator[str]:
    """Yield which files of a folder of recordings are not read."""
    for file in other_files(folder):
        if file.is_dir():
            yield f"the recordings in the folder {file.name} are not read: move them to {folder}"
        else:
            yield f"{file.name} is not read: recordings are .csv files (`palpate read` converts vendors' files)"


def _cut(condition: Condition, tests: Sequence[Recording]) -> Iterator[str]:
    """Report tests that last longer than the load history that their condition follows."""
    duration = float(condition.protocol.sample_time[-1])
    which = "the first file by name" if condition.follows == RECORDED else condition.follows
    for test in tests:
        lasts = float(test.from_contact().time[-1])
        if lasts > LONGER * duration:
            yield (
                f"{test.name}.csv lasts {lasts:.4g} s, the recorded load that its condition follows ends after "
                f"{duration:.4g} s: later points are ignored ({which} is followed)"
            )


def _jumps(tests: Sequence[Recording]) -> Iterator[str]:
    """Report the tests in which the depth jumps."""
    found = {test.name: max(jumps, key=lambda each: each.jump) for test in tests if (jumps := pop_ins(test))}
    if found:
        name, largest = max(found.items(), key=lambda pair: pair[1].jump)
        yield (
            f"{name}.csv{and_more(found)}: the depth jumps while the load grows, by {largest.jump:.3g} nm at "
            f"{largest.load:.3g} mN (a pop-in, a crack, or a tip that slipped); no law describes that"
        )


def _gaps(tests: Sequence[Recording]) -> Iterator[str]:
    """Report the tests in which a time without points is long beside both the sampling and the test."""
    found = []
    for test in tests:
        step = np.diff(test.time)
        longest = int(np.argmax(step))
        if step[longest] > max(STEPS * float(np.median(step)), GAP * float(np.ptp(test.time))):
            found.append((test, longest))
    if found:
        test, longest = found[0]
        begin, end = test.time[longest], test.time[longest + 1]
        yield (
            f"{test.name}.csv{and_more(found)}: no points between {begin:.4g} and {end:.4g} s ({end - begin:.3g} s): "
            "load and depth are taken to run straight there"
        )


def _lagging(tests: Sequence[Recording]) -> Iterator[str]:
    """Report a lag of the depth behind the load, or ahead of it, that the corners of the load's history show."""
    found = reversal_lag(test.from_contact() for test in tests[:MOST_TESTS])
    step = float(np.median([np.median(np.diff(test.time)) for test in tests]))
    if found is None or found.lower <= 0.0 <= found.upper or abs(found.lag) < LEAST_LAG * step:
        return
    way = "behind" if found.lag > 0 else "ahead of"
    size, low, high = abs(found.lag), *sorted((abs(found.lower), abs(found.upper)))
    yield (
        f"the depth lies {size:.2g} s {way} the load where the load's rate changes ({low:.2g} to {high:.2g} s, "
        f"{found.corners} corners): a lag of the controller (mechanism controller_lag)"
    )


def _pulled(condition: Condition, tests: Sequence[Recording]) -> Iterator[str]:
    """Report the tests that the surface pulls on; a condition under load control has no load below zero."""
    found = {test.name: pull for test in tests if (pull := pull_off(test))}
    if found:
        name, largest = max(found.items(), key=lambda pair: pair[1])
        counted = ": loads below zero count as zero" if condition.protocol.control == LOAD else ""
        yield f"{name}.csv{and_more(found)}: the surface pulls on the tip by up to {largest:.3g} mN{counted}"


def _averaged(condition: Condition, tests: Sequence[Recording]) -> Iterator[str]:
    """Report the tests of whose load or displacement an average is followed."""
    followed = tests if condition.own_loads else tests[:1] if condition.follows == RECORDED else ()
    drives = [(test, condition.protocol.drive_of(test.load, test.depth)) for test in followed]
    found = [(test, drive, over) for test, drive in drives if (over := averaged_over(test.time, drive)) > 1]
    if found:
        test, drive, over = found[0]
        share, span = swing(drive, over) / drive.max(), over * float(np.median(np.diff(test.time)))
        yield (
            f"{test.name}.csv{and_more(found)}: the {condition.protocol.control} oscillates or is noisy by "
            f"{share:.1%} of its largest; its average over {span:.3g} s is followed"
        )
