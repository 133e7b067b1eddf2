"""Results as JSON files, and the checksums by which a result that was altered is recognised.

Each job leaves the checksums of its results beside its log, in a file that ``sha256sum --check`` reads, under the name
of its rule. While a result is no longer as its job made it, no execution begins that would use it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from indentation_files.whole_file import written_whole
from palpate.base.checksum import checksum
from palpate.errors import InputError, PalpateError

SEAL, RULE = ".sha256", "# "  # ending of the file; what the line with the name of the rule begins with


class Altered(NamedTuple):
    """A result that is no longer as a job of the rule made it."""

    file: Path
    rule: str


def write_json(path: str | Path, content: Mapping[str, Any] | Sequence[Any]) -> None:
    """Write JSON; the file appears whole or not at all."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(path) as partial:
        partial.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def read_json(path: str | Path) -> Any:
    """Read JSON that the workflow wrote.

    Raises
    ------
    PalpateError
        When it was cut or altered so that it is JSON no more, or is no file.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError, IsADirectoryError) as error:
        raise PalpateError(f"{path} is damaged ({error}); delete it and run the study again") from error


def seal(log: str | Path, results: Iterable[str | Path], rule: str = "") -> None:
    """Write the checksums of the results of a job of a rule beside its log."""
    lines = [f"{checksum(file)}  {file}\n" for file in map(Path, results) if file.is_file()]
    Path(log).with_suffix(SEAL).write_text("".join([f"{RULE}{rule}\n", *lines]), encoding="utf-8")


def unseal(log: str | Path) -> None:
    """Remove the checksums of a job's former results, which it is about to replace."""
    Path(log).with_suffix(SEAL).unlink(missing_ok=True)


def altered(logs: Path) -> list[Altered]:
    """Return the results that are no longer as the jobs whose logs lie in a folder made them; missing ones are not.

    Of a result that two logs name, as where an earlier version named them otherwise, the later one counts.
    """
    made: dict[str, tuple[str, str]] = {}
    for sealed in sorted(logs.rglob(f"*{SEAL}"), key=lambda file: (file.stat().st_mtime_ns, file)):
        rule = ""
        for line in sealed.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith(RULE):
                rule = line.removeprefix(RULE)
                continue
            known, _, name = line.partition("  ")
            made[name] = known, rule
    return [
        Altered(file, rule)
        for file, (known, rule) in sorted((Path(name), entry) for name, entry in made.items() if name)
        if file.is_relative_to(logs.parent) and file.is_file() and checksum(file) != known
    ]


def refuse_altered(logs: Path, arguments: Sequence[str] = ()) -> None:
    """Refuse results that were altered, unless they are made again.

    Parameters
    ----------
    logs
        Folder of the logs.
    arguments
        Of Snakemake, whose ``--forcerun`` names rules or files to make again, and ``--forceall`` all.

    Raises
    ------
    InputError
        With the files, and the rules that make them.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-R", "--forcerun", nargs="*", default=[])
    parser.add_argument("-F", "--forceall", action="store_true")
    given, _ = parser.parse_known_args(arguments)
    found = [] if given.forceall else [e for e in altered(logs) if not {e.rule, str(e.file)} & set(given.forcerun)]
    if found:
        rules = " ".join(sorted({each.rule or str(each.file) for each in found}))
        raise InputError(
            "is not as its job made it" if len(found) == 1 else "are not as their jobs made them",
            remedy=f"delete {'it' if len(found) == 1 else 'them'}, or make all again with --forcerun {rules}",
            file=", ".join(str(each.file) for each in found),
        )


def calibration_of(file: str | Path) -> dict[str, Any]:
    """Return the content of the file of a calibration.

    Raises
    ------
    PalpateError
        When it was written before the discrepancy of the law was estimated: its estimate is another one.
    """
    found = read_json(file)
    if "discrepancy" not in found:
        raise PalpateError(f"{file} was written by an older version of palpate; delete it and run the study again")
    return found
