"""The command that reads: an instrument's file in, recording CSVs out; `palpate read` is the same with figures."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from indentation_files.errors import InputError
    from indentation_files.survey import Survey

HELP = "convert an instrument's file to one CSV for each test"


class Parser(argparse.ArgumentParser):
    """A parser whose complaints fit on one line, and to which -1e-3 is as much a number as -5."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self._negative_number_matcher = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def error(self, message: str) -> NoReturn:
        """Print `message` and leave with exit code 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def path(text: str) -> Path:
    """Return the path that an argument names; ``~`` in quotes is the home folder, too."""
    return Path(text).expanduser()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("file", type=path, metavar="FILE", help="the instrument's file, or a table")
    parser.add_argument("--test", metavar="NAME_OR_NUMBER", help="one test only (default: all)")
    reading_arguments(parser)
    parser.add_argument(
        "--stiffness",
        action="store_true",
        help="add a fourth column with the stiffness by oscillation, where the file has it",
    )
    parser.add_argument(
        "--survey", action="store_true", help="also write a figure and a table of contact, segments and drift"
    )
    parser.add_argument("--formats", action=_Formats, nargs=0, help="list the known formats and units")
    parser.add_argument("-o", "--output", type=path, required=True, metavar="FOLDER", help="the folder that is written")


def reading_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare how vendors' files are read."""
    chosen = parser.add_mutually_exclusive_group()
    chosen.add_argument(
        "--raw",
        dest="corrections",
        action="store_const",
        const=frozenset(),
        help="apply none of the vendor's corrections of drift and frame",
    )
    chosen.add_argument(
        "--correct",
        dest="corrections",
        type=_corrections,
        metavar="NAMES",
        help="apply only these of the vendor's corrections: drift, frame, or drift,frame",
    )
    parser.add_argument(
        "--contact",
        type=_contact,
        default="file",
        metavar="file|auto|none|NM",
        help="where a test begins: at the contact that the file marks (file, the default) or that palpate finds "
        "(auto), at a depth (a number in nm), or with the first row (none)",
    )
    parser.add_argument(
        "--columns", type=_pairs, metavar="time=A,load=B,depth=C", help="names or numbers of the columns of a table"
    )
    parser.add_argument(
        "--units",
        type=_pairs,
        default={},
        metavar="time=s,load=mN,depth=nm",
        help="units of these columns, in place of those that the table states; load=-mN changes the sign",
    )


class _Formats(argparse.Action):
    """Print what can be read, found when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *given: object) -> None:
        from indentation_files.readers import READERS
        from indentation_files.readers.units import SCALES

        print(*(reader.title for reader in READERS.values()), sep="\n")
        print("any table, text or Excel, by --columns; units:")
        print(*(f"  {key}: {', '.join(units)}" for key, units in SCALES.items()), sep="\n")
        parser.exit()


def _corrections(text: str) -> frozenset[str]:
    chosen = frozenset(text.split(","))
    if not chosen <= {"drift", "frame"}:
        raise argparse.ArgumentTypeError(f"{text!r} is not drift, frame or drift,frame")
    return chosen


def _contact(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        if text not in ("file", "auto", "none"):
            raise argparse.ArgumentTypeError(f"{text!r} is not file, auto, none or a depth in nm") from None
        return text


def _pairs(text: str) -> dict[str, str]:
    pairs = [part.split("=", 1) for part in text.split(",")]
    if any(len(pair) != 2 for pair in pairs):
        raise argparse.ArgumentTypeError(f"{text!r} is not time=...,load=...,depth=...")
    keys = [key.strip() for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise argparse.ArgumentTypeError(f"{twice!r} is given twice")
    return {key: value.strip() for key, (_, value) in zip(keys, pairs, strict=True)}


Report = Callable[[object], None]
Draw = Callable[..., object]


def run(arguments: argparse.Namespace, report: Report, draw: Draw | None = None) -> int:
    """Write one CSV a test, with what the file states of it as comments; with ``--survey`` a table and figures too.

    The `arguments` are those of `add_arguments`. `report` is called with one line on what was left out, sought or
    assumed. `draw` draws a survey into a file; without it there are no figures.
    """
    from indentation_files import readers
    from indentation_files.errors import located_in
    from indentation_files.overwrite import checked_output
    from indentation_files.readers.vendor import provenance
    from indentation_files.readers.zero import decision
    from indentation_files.survey import Survey, survey_each

    with located_in(arguments.file):
        columns = readers.ColumnMap.stated(arguments.columns, arguments.units)
        tests = readers.read_each(arguments.file, corrections=arguments.corrections, contact="none", columns=columns)
        if arguments.test is not None:
            tests = [readers.select(tests, arguments.test, arguments.file)]
        begun = readers.zeroed_each(arguments.file, tests, arguments.contact)
        readable = [
            (readers.raise_if_unreadable(whole), test)
            for whole, test in zip(tests, begun, strict=True)
            if isinstance(test, readers.VendorTest)
        ]
        surveys = survey_each([whole.recording for whole, _ in readable]) if arguments.survey else []
        taken = [decision(whole.recording, test.recording) for whole, test in readable]
    paths = [
        checked_output(arguments.file, each) for each in _paths(arguments.output, [test.name for _, test in readable])
    ]
    arguments.output.mkdir(parents=True, exist_ok=True)
    for line in readers.messages(arguments.file, begun):
        report(line)
    if arguments.stiffness:
        without = [test.name for _, test in readable if test.recording.stiffness is None]
        names = "" if len(without) == len(readable) else f" in {', '.join(without)}"
        if without:
            report(f"{arguments.file}: holds no stiffness by oscillation{names}; no column is added")
    for number, (file, (_, test)) in enumerate(zip(paths, readable, strict=True)):
        stiffness = test.recording.stiffness if arguments.stiffness else None
        notes = provenance(test, arguments.corrections)
        place = _written(file, replace(test.recording, notes=notes, stiffness=stiffness).write, report)
        if draw and surveys and isinstance(found := surveys[number], Survey):
            _written(place.with_suffix(".png"), partial(draw, found, taken=taken[number]), report)
    if surveys:
        _write_table(arguments.file, arguments.output, surveys, taken, report)
    return 0


def _written(path: Path, write: Callable[[Path], object], report: Report) -> Path:
    """Write a file, never over another content; print where, and return that place."""
    from indentation_files.overwrite import written_beside

    place = written_beside(path, write)
    if place != path:
        report(f"{path}: exists with another content; written to {place}")
    print(place)
    return place


def _write_table(
    file: Path, folder: Path, surveys: Sequence[Survey | InputError], taken: Sequence[tuple[str, float]], report: Report
) -> None:
    """Write the table of a file's surveys, and report which tests it leaves out."""
    from indentation_files.survey import Survey, table

    rows = []
    for found, decided in zip(surveys, taken, strict=True):
        if isinstance(found, Survey):
            rows.append((found, decided))
        else:
            report(f"{found.located(file=file)}; left out of the survey")
    text = table(*zip(*rows, strict=True)).to_csv(index=False, sep="\t", float_format="%.5g")
    _written(folder / f"{file.stem}_survey.txt", lambda place: place.write_text(text, encoding="utf-8"), report)


def _paths(folder: Path, names: list[str]) -> list[Path]:
    """Return a path for each test, after its name."""
    paths: list[Path] = []
    for number, name in enumerate(names, 1):
        stem = re.sub(r"[^A-Za-z0-9._-]+", "_", name)
        while folder / f"{stem}.csv" in paths:
            stem += f"_{number}"
        paths.append(folder / f"{stem}.csv")
    return paths
