"""``palpate check``: are a study and its recordings valid, before anything is simulated."""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli import path

if TYPE_CHECKING:
    from indentation_files.recording import Recording
    from palpate.configuration.study_file import Study
    from palpate.data.bulk_tests import BulkTest

NAME = "check"
HELP = "check a study and its recordings, and estimate how long it takes"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", type=path, metavar="STUDY.yaml", help="the study")
    parser.add_argument("--data", help="the instrument's file, in place of source.file in the study")


def run(arguments: argparse.Namespace) -> int:
    """Check the study, and every set of recordings that is not written by the study itself; print what it will do."""
    from palpate.base.yaml_file import read_yaml
    from palpate.configuration.study_file import load_study
    from palpate.workflow_support.expected_time import expected
    from palpate.workflow_support.job import plain
    from palpate.workflow_support.manifest import changed

    study = load_study(arguments.study, arguments.data)
    print(f"relative paths count from {Path.cwd()}")
    print(*examined(study), *expected(study, os.cpu_count() or 1), sep="\n")
    data = ["--data", arguments.data] if arguments.data else []
    print("next:", shlex.join(["palpate", "run", str(arguments.study), *data]))
    for line in changed(study, plain(read_yaml(arguments.study)), Path("results") / study.name):
        print(f"{line}: run the study again")
    return 0


def examined(study: Study) -> Iterator[str]:
    """Check a study and its recordings, each read once, and yield what will be done; raises `InputError`."""
    from palpate.data.study_recordings import tests_to_come
    from palpate.workflow_support.check_study import checked
    from palpate.workflow_support.data_quality import anomalies, misstated

    counts: dict[str, dict[str, int]] = {name: {} for name in study.recordings}
    remarks: dict[str, list[str]] = {name: [] for name in study.recordings}

    def look(name: str, condition: str, tests: list[Recording]) -> None:
        counts[name][condition] = len(tests)
        remarks[name].extend(anomalies(tested[condition], tests))

    tested = study.tested
    checked(study, look)
    for condition, tests in (study.source_tests() if study.source else {}).items():
        said = remarks[study.source["recordings"]]
        said.extend(misstated(tested[condition], [test.recording for test in tests]))
        said.extend(f"{test.name}: {warning}" for test in tests for warning in test.warnings)
    counts = {name: seen or tests_to_come(study, name) for name, seen in counts.items()}
    yield from _described(study, counts, remarks)


def _described(
    study: Study, counts: Mapping[str, Mapping[str, int]], remarks: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Yield what a study simulates, how many tests each set of recordings holds, remarks on them, and limits."""
    from palpate.data.bulk_tests import bulk_tests
    from palpate.data.study_recordings import written_by_workflow
    from palpate.materials.families import FAMILIES
    from palpate.models.imprints import imprints
    from palpate.output.results.law_candidates import choice_sentences
    from palpate.output.tip_words import tip_in_words
    from palpate.solver.store import conditions_by_shape
    from palpate.workflow_support.data_quality import cycles_to_hold_out, passed_over

    calibrated, materials = [condition.name for condition in study.calibrated], len(study.cells)
    conditions, count = len(study.tested), materials * len(calibrated)
    plural = "s" if conditions > 1 else ""
    yield f"{study.file}: {materials} materials, {conditions} condition{plural}, {count} snapshots"
    if study.choice:
        yield choice_sentences(study.choice)
    elif study.law_is_open:
        laws = FAMILIES[study.family].laws
        yield f"recordings {next(iter(study.recordings))} will choose among {len(laws)} laws: {', '.join(laws)}"
    if study.instrument:
        yield study.instrument.in_words
    for alike in conditions_by_shape(study):
        if len(alike) > 1:
            yield f"{', '.join(c.name for c in alike)} differ in size alone: one simulation gives them all"
    for tip, pressed in (study.by_tip(study.tested.values()) if study.tips else {}).items():
        yield f"{', '.join(c.name for c in pressed)}: {tip and tip + ', '}{tip_in_words(study.tip_of(pressed[0]))}"
    held_out = ", ".join(c.name for c in study.conditions if c.role == "validate") or "no condition"
    yield f"calibrated on {', '.join(calibrated)}; validated on {held_out}"
    if held_out == "no condition":
        yield from cycles_to_hold_out(study)
    yield from map(_bulk_test, bulk_tests(study))
    for imprint in imprints(study):
        profile = imprint.profile
        yield (
            f"evidence {profile.name}: imprint of {imprint.condition.name}, {len(profile.radius)} points to "
            f"{profile.radius[-1]:.4g} nm, {-profile.height.min():.4g} nm deep; it judges the calibrated law"
        )
    if not study.recordings:
        yield "no recordings: nothing will be calibrated or diagnosed; name a folder under recordings"
    for name, folder in study.recordings.items():
        tests = counts[name]
        found = ", ".join(f"{number} of {condition}" for condition, number in tests.items())
        yield f"recordings {name} in {os.path.realpath(folder)}: {found}"
        unread = () if written_by_workflow(study, name) else passed_over(folder)
        yield from (f"recordings {name}: {remark}" for remark in (*unread, *remarks[name]))
        repeated = [condition for condition in calibrated if tests[condition] > 1]
        if study.diagnosis.enabled and 2 * len(repeated) <= len(calibrated):
            yield f"recordings {name}: too few tests are repeated for the diagnosis to identify an effect"


def _bulk_test(found: BulkTest) -> str:
    """Return what is taken of a uniaxial test, in one line."""
    test, used = found.test, "is fitted as well" if found.role == "calibrate" else "judges the calibrated law"
    return (
        f"evidence {found.name}: uniaxial test of {len(test.time)} points in {test.time[-1] - test.time[0]:.4g} s, "
        f"strain {test.strain.min():.3g} to {test.strain.max():.3g}, stress {test.stress.min():.3g} to "
        f"{test.stress.max():.3g} GPa; the {found.control} is taken as prescribed, the {found.observed} {used}"
    )
