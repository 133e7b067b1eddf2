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
    parser.add_argument("--raw", action="store_true", help="leave the vendor's corrections off")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")


def run(arguments: argparse.Namespace) -> int:
    """Write one CSV a test, with what the file says of it as comments."""
    from palpate.readers import read_vendor_file, select

    tests = read_vendor_file(arguments.file, raw=arguments.raw)
    if arguments.test is not None:
        tests = [select(tests, arguments.test, arguments.file)]
    arguments.output.mkdir(parents=True, exist_ok=True)
    for test in tests:
        notes = (*test.recording.notes, *(f"{key}: {value}" for key, value in test.metadata.items()))
        path = arguments.output / f"{re.sub(r'[^A-Za-z0-9._-]+', '_', test.name)}.csv"
        replace(test.recording, notes=notes).write(path)
        print(path)
    return 0
