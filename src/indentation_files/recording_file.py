"""Recordings in CSV files: found in a folder, read and checked.

Files are read by columns, large ones in blocks; what such a reader does not accept is read again line by line, to
report what is wrong and where.
"""

from __future__ import annotations

import math
import os
import re
from array import array
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from indentation_files.errors import InputError, located_in
from indentation_files.recording import (
    HEADER,
    MOST,
    STIFFNESS_FOLDER,
    WITH_STIFFNESS,
    Recording,
    check_points,
    marked_synthetic,
    spaced,
    stiffness_file,
)
from indentation_files.regular_file import refuse_special

HISTORIES = {"load": "time_s,load_mN", "displacement": "time_s,displacement_nm"}  # headers of what is prescribed alone
BLOCK = 1 << 22  # bytes that are read at once
LONGEST = 1 << 20  # letters of a line
LARGE = 20_000  # bytes, from which pyarrow, which takes longer to begin, reads faster


def recording_files(folder: Path) -> list[Path]:
    """Return the recordings in a folder, CONDITION_REPLICATE.csv each, by name; none where there is no folder."""
    return _visible(folder, recordings=True)


def other_files(folder: Path) -> list[Path]:
    """Return what a folder holds besides recordings, by name: other files, and folders with recordings of their own."""
    others = [file for file in _visible(folder, recordings=False) if file.name != STIFFNESS_FOLDER]
    return [file for file in others if file.is_file() or recording_files(file)]


def _visible(folder: Path, recordings: bool) -> list[Path]:
    """Return what a folder holds by name: what is named as recordings are, or all else; hidden files do not count."""
    names = os.listdir(folder) if folder.is_dir() else ()
    chosen = (name for name in names if name.lower().endswith(".csv") == recordings and not name.startswith("."))
    return [folder / name for name in sorted(chosen)]


def condition_of(file: Path) -> str:
    """Return the condition that the name of a recording's file begins with; empty where no replicate follows."""
    condition, _, replicate = file.stem.rpartition("_")
    return condition if replicate.strip() else ""


def holds_synthetic(folder: Path) -> bool:
    """Return whether any recording in a folder is marked as simulated; reads the comments above the headers only."""
    return any(marked_synthetic(_begun(_numbered(file))[0]) for file in recording_files(folder))


def read_recording(path: str | Path) -> Recording:
    """Read a recording CSV and check it; its stiffness may lie in a folder beside (`Recording.write_apart`).

    Raises `InputError` when the file is missing, empty, has another header, text, gaps or times that do not increase,
    or the stiffness beside it is that of other times.
    """
    path = Path(path)
    return with_stiffness_beside(_recording_at(path), path)


def with_stiffness_beside(recording: Recording, path: Path) -> Recording:
    """Return the recording of a CSV with the stiffness that lies in a folder beside it; raises `InputError`."""
    beside = stiffness_file(path)
    if recording.stiffness is not None or not beside.is_file():
        return recording
    measured = _recording_at(beside)
    if not np.array_equal(measured.time, recording.time):
        raise InputError(f"has other times than {path}", remedy="remove it, or convert the test again", file=beside)
    return replace(recording, stiffness=measured.stiffness)


def read_history(path: Path, control: str) -> Recording:
    """Read what is prescribed: a recording, or a CSV of ``time_s,load_mN`` or ``time_s,displacement_nm`` alone.

    A displacement alone is the depth of a recording without load: depth + load / spring is right. Raises
    `InputError` as `read_recording`, and when a file holds the other of the two.
    """
    lines = _numbered(path)
    _, _, heading = _begun(lines)
    if heading not in HISTORIES.values():
        return read_recording(path)
    with located_in(path):
        if heading != HISTORIES[control]:
            problem = f"header is {heading!r}, but the {control} is prescribed"
            raise InputError(problem, remedy=f"give {HISTORIES[control]!r}, or a recording")
        time, drive = _columns(lines, heading)
        load, depth = (drive, np.zeros_like(drive)) if control == "load" else (np.zeros_like(drive), drive)
        return Recording(time, load, depth, path.stem)


def read_table(path: Path, header: str) -> tuple[np.ndarray, list[str]]:
    """Return the columns (k, n) of a CSV that has a `header`, and all of its comments.

    Raises `InputError` when the file is missing, has another header, or a line is no such numbers.
    """
    lines = _numbered(path)
    notes, number, found = _begun(lines)
    with located_in(path):
        if found != header:
            problem = f"header is {found[:60]!r}, expected {header!r}" if found else f"is empty, expected {header!r}"
            remedy = "name the columns like that, in these units, separated by commas"
            raise InputError(problem, remedy=remedy, place=f"line {number}" if found else None)
        return _columns(lines, header, notes), notes


def _recording_at(path: Path) -> Recording:
    """Return the recording in one CSV, checked."""
    with errors_of_reading(path):
        large = path.stat().st_size > LARGE
    return _checked(_numbered(path), path, large)


def recording_in(lines: Sequence[str], path: Path) -> Recording:
    """Return the recording that the `lines` of a CSV hold, as `read_recording` does, but without a stiffness beside."""
    recording = _checked(enumerate(lines, 1), path, large=False)
    return recording if len(recording) <= MOST else recording.at(spaced(np.arange(len(recording)))[0])


def _numbered(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text file with their numbers; raises `InputError`."""
    refuse_special(path)
    with errors_of_reading(path), path.open(encoding="utf-8-sig") as stream:
        for number, line in enumerate(iter(lambda: stream.readline(LONGEST), ""), 1):
            if len(line) == LONGEST:
                problem, remedy = "the line is longer than that of any table", "export or copy the test again"
                raise InputError(problem, remedy=remedy, file=path, place=f"line {number}")
            yield number, line


@contextmanager
def errors_of_reading(path: Path) -> Iterator[None]:
    """Turn what reading a file raises into `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", remedy="check the path", file=path) from error
    except UnicodeDecodeError as error:
        remedy = "save it as UTF-8, or convert vendor files with `palpate read`"
        raise InputError("is not text in UTF-8", remedy=remedy, file=path) from error


def _begun(lines: Iterable[tuple[int, str]]) -> tuple[list[str], int, str]:
    """Return the comments that precede the header, its number, and the header; empty where there is none."""
    notes = []
    for number, line in lines:
        if line.startswith("#"):
            notes.append(line[1:].strip())
        elif line.strip():
            return notes, number, line.strip()
    return notes, 0, ""


def _columns(lines: Iterable[tuple[int, str]], header: str, notes: list[str] | None = None) -> np.ndarray:
    """Return the columns (k, n) of numbers in numbered lines; comments among them are added to the `notes`.

    Raises `InputError` on any other line.
    """
    numbers, names = array("d"), header.split(",")
    for number, line in lines:
        if line.startswith("#"):
            if notes is not None:
                notes.append(line[1:].strip())
            continue
        if not line.strip():
            continue
        try:
            row = [float(cell) for cell in line.split(",")]
        except ValueError:
            row = []
        if len(row) != len(names):
            problem = f"{line.strip()[:40]!r} is not {('two', 'three', 'four')[len(names) - 2]} numbers"
            remedy = f"write {', '.join(names[:-1])} and {names[-1]} with decimal points"
            raise InputError(problem, remedy=remedy, place=f"line {number}")
        numbers.extend(row)
    return np.frombuffer(numbers, dtype=float).reshape(-1, len(names)).T.copy()


def _by_columns(path: Path, header: int, width: int) -> list[np.ndarray] | None:
    """Return the columns (n,) of numbers below the header of a large file; nothing where it holds anything else.

    Of more than `MOST` points every second, third, ... is kept, and the last (`recording.spaced`). Raises `InputError`
    when a time, load or depth is not a number, or a time does not increase; points that are not kept count as well.
    """
    import pyarrow as pa
    from pyarrow import csv

    names = [str(k) for k in range(width)]
    reading = csv.ReadOptions(skip_rows=header, column_names=names, block_size=BLOCK)
    converting = csv.ConvertOptions(column_types=dict.fromkeys(names, pa.float64()), null_values=[])
    kept, count, every = list[np.ndarray](), 0, max(math.ceil((_line_count(path) - header) / MOST), 1)
    try:
        with csv.open_csv(path, read_options=reading, convert_options=converting) as stream:
            last = np.empty((width, 0))
            for block in stream:
                rows = np.column_stack([last, np.array([column.to_numpy() for column in block.columns])])
                check_points(rows[0], rows[1], rows[2], first=count + 1 - last.shape[1])
                kept.append(rows[:, last.shape[1] + -count % every :: every].copy())
                last, count = rows[:, -1:].copy(), count + len(block)
    except pa.ArrowInvalid:
        return None
    if count and (count - 1) % every:
        kept.append(last)
    return list(np.concatenate(kept, axis=1)) if kept else None


def _line_count(path: Path) -> int:
    """Return how many lines of a file are ended."""
    with path.open("rb") as stream:
        return sum(block.count(b"\n") for block in iter(lambda: stream.read(BLOCK), b""))


def _checked(lines: Iterator[tuple[int, str]], path: Path, large: bool) -> Recording:
    """Return the recording that numbered lines hold; raises `InputError` as `read_recording` does."""
    notes, number, header = _begun(lines)
    place, width = f"line {number}", len(header.split(","))
    with located_in(path):
        if not header:
            raise InputError("the recording is empty", remedy="export the test again")
        if re.split(r"[;\t]", header) in (HEADER.split(","), WITH_STIFFNESS.split(",")):
            remedy = "separate them by commas, or let `palpate read --columns` write the file anew"
            raise InputError("the columns are not separated by commas", remedy=remedy, place=place)
        if header not in (HEADER, WITH_STIFFNESS):
            problem = f"header is {header[:60]!r}, expected {HEADER!r}"
            raise InputError(problem, remedy="rename the columns, with these units", place=place)
        found = _by_columns(path, number, width) if large else None
        time, load, depth, *stiffness = _columns(lines, header, notes) if found is None else found
        return Recording(time, load, depth, path.stem, tuple(notes), stiffness[0] if stiffness else None)
