"""``palpate read``: a vendor's file in, recording CSVs out."""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path

NAME = "read"
HELP = "turn a vendor's file into recording CSVs"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.add_argument("--test", metavar="NAME_OR_NUMBER", help="one test only (default: all)")
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument(
        "--raw", dest="corrections", action="store_const", const=frozenset(), help="leave the vendor's corrections off"
    )
    chosen.add_argument(
        "--correct",
        dest="corrections",
        type=_corrections,
        metavar="NAMES",
        help="apply these alone, such as drift,frame",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")


def _corrections(text: str) -> frozenset[str]:
    chosen = frozenset(text.split(","))
    if not chosen <= {"drift", "frame"}:
        raise argparse.ArgumentTypeError(f"{text!r} is not drift, frame or drift,frame")
    return chosen


def run(arguments: argparse.Namespace) -> int:
    """Write one CSV a test, with what the file says of it as comments."""
    from palpate.readers import read_vendor_file, select

    tests = read_vendor_file(arguments.file, corrections=arguments.corrections)
    if arguments.test is not None:
        tests = [select(tests, arguments.test, arguments.file)]
    chosen = arguments.corrections
    named = "those of the vendor" if chosen is None else ", ".join(sorted(chosen)) or "none"
    applied = f"corrections in depth: {named}"
    arguments.output.mkdir(parents=True, exist_ok=True)
    for test in tests:
        notes = (*test.recording.notes, applied, *(f"{key}: {value}" for key, value in test.metadata.items()))
        path = arguments.output / f"{re.sub(r'[^A-Za-z0-9._-]+', '_', test.name)}.csv"
        replace(test.recording, notes=notes).write(path)
        print(path)
    return 0
