"""``palpate check``: is a study sound, and are its recordings, before anything is simulated."""

from __future__ import annotations

import argparse
from pathlib import Path

NAME = "check"
HELP = "check a study and its recordings"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", type=Path, metavar="STUDY.yaml")
    parser.add_argument("--data", help="vendor's file, in place of the study's source.file")


def run(arguments: argparse.Namespace) -> int:
    """Check the study, and every set of recordings that is not written by the study itself."""
    from palpate.config import load_study
    from palpate.diagnosis.design import candidates
    from palpate.observations import check_given

    study = load_study(arguments.study, data=arguments.data)
    check_given(study)
    if study.diagnosis["enabled"]:
        candidates(study)
    count = len(study.cells) * sum(condition.role == "calibrate" for condition in study.conditions)
    print(f"{arguments.study}: {len(study.cells)} cells, {len(study.conditions)} conditions, {count} snapshots")
    return 0
