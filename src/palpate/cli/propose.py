"""``palpate propose``: the test that would settle best what a diagnosis left open, as a method and as a study."""

from __future__ import annotations

import argparse
from pathlib import Path

from palpate.errors import InputError

NAME = "propose"
HELP = "write the next test that a diagnosis proposes: a method for the laboratory, and the study that holds it"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", metavar="STUDY", help="the study's file, or its name below results")
    parser.add_argument(
        "--recordings", metavar="SET", help="the set of recordings (default: the first with a proposal)"
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FOLDER", help="where both are written (default: results/STUDY/SET/next)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the proposed test of a set of recordings, and print the method.

    Raises
    ------
    InputError
        When there is no such study or set, or its recordings were not diagnosed.
    """
    from palpate.configuration.checked_file import suggestion
    from palpate.configuration.study_file import study_from
    from palpate.workflow_support.job import plain
    from palpate.workflow_support.named_study import named_study
    from palpate.workflow_support.proposal import Proposal
    from palpate.workflow_support.result_files import read_json

    values, file = named_study(arguments.study)
    study = study_from(plain(values), file)
    sets = [arguments.recordings] if arguments.recordings else list(study.recordings)
    for name in sets:
        if name not in study.recordings:
            remedy = f"use one of: {', '.join(study.recordings)}"
            problem = f"{name!r} is no set of recordings of {study.name}{suggestion(name, study.recordings)}"
            raise InputError(problem, remedy=remedy, place="--recordings")
    verdicts = []
    for name in sets:
        results = Path("results") / study.name / name
        if not (results / "diagnosis.json").is_file():
            remedy = f"run the study with its diagnosis first: palpate run {arguments.study}"
            raise InputError("is missing", remedy=remedy, file=results / "diagnosis.json")
        diagnosis = read_json(results / "diagnosis.json")
        verdicts.append(f"{name} is {diagnosis['verdict']}")
        if diagnosis["discriminating_test"]:
            proposal = Proposal(study, plain(values), name, diagnosis, arguments.output or results / "next")
            study_from(proposal.next_study(), proposal.folder / "study.yaml")
            written = proposal.write()
            print(proposal.method(), *written, f"next: palpate check {written[-1]}", sep="\n")
            return 0
    print(f"no test is proposed: {', '.join(verdicts) or 'the study has no recordings'}")
    return 0
