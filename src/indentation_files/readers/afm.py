"""Force curves of atomic force microscopes (JPK, Asylum/Igor, AFM HDF5 and tab), read by the library ``afmformats``.

The tip is where the height sensor is, moved by the cantilever's deflection: depth = -(height + force / stiffness).
These files mark no contact; time and depth are counted from the start of the curve, so contact must be found or given.
"""

from __future__ import annotations

import io
import logging
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from indentation_files.bounded_process import BEYOND, MEMORY, problem_of
from indentation_files.errors import InputError
from indentation_files.readers.igor import HEADERS, is_wave, sampling, stated
from indentation_files.readers.source import HDF5, ZIP, Source
from indentation_files.readers.vendor import Reader, Unreadable, VendorTest, read_or_report, usable, vendor_test

TAB = b"# afmformats"
METADATA = b"BEGIN METADATA"
SHORT = 120  # letters of a library's reason
JPK_ENDINGS = (".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series")
HEIGHTS = ("height (measured)", "height (piezo)")
CALIBRATION = {"spring constant": b"SpringConstant", "sensitivity (InvOLS)": b"InvOLS"}
BY_PIEZO = "the height is the piezo's voltage, not a sensor's: creep and hysteresis of the piezo are in the depth"
UNCALIBRATED = "calibrate the cantilever in the vendor's program and save the curve again, or export its force as text"


def matches(source: Source) -> bool:
    """Return whether this is a file of ``afmformats``, an Igor wave of a cantilever, or a zip archive of JPK's."""
    return _ending(source) is not None


def _ending(source: Source) -> str | None:
    """Return the ending by which ``afmformats`` knows the format."""
    begun = source.begun
    if begun.startswith(HDF5) and b"afmformats" in source.content:
        return ".h5"
    if begun.startswith(TAB) and METADATA in begun:
        return ".tab"
    if begun.startswith(tuple(HEADERS)) and is_wave(source.content):
        return ".ibw"
    if begun.startswith(ZIP) and b"header.properties" in source.content:
        return source.path.suffix if source.path.suffix in JPK_ENDINGS else JPK_ENDINGS[0]
    return None


def read(source: Source) -> list[VendorTest | Unreadable]:
    """Read all curves of the file, with their approach.

    Raises `InputError` when the library is missing, the file states no spring constant, or no curve can be read.
    """
    ending = _ending(source)
    if ending == ".ibw" and (lacking := [name for name, key in CALIBRATION.items() if not stated(source.content, key)]):
        raise not_stated(*lacking)
    try:
        from afmformats import errors, load_data
    except ImportError as error:
        problem = "force curves need the library afmformats"
        raise InputError(problem, remedy="install it: pip install afmformats") from error
    if problem := _unreadable(source.content):
        raise InputError(f"afmformats cannot read it ({problem})", remedy="copy or export it again")
    with tempfile.TemporaryDirectory() as folder, _silence():
        copy = Path(folder) / f"curve{ending}"
        copy.write_bytes(source.content)
        try:
            tests = [
                read_or_report(source.path, f"curve {number}", _test, source, number, curve)
                for number, curve in enumerate(load_data(copy), 1)
            ]
        except errors.MissingMetaDataError as error:
            raise not_stated(*error.meta_keys) from error
        except (Exception, errors.AFMFileFormatError) as error:
            remedy = "export the curve as text, with time, force and height (JPK's text export is read)"
            raise InputError(f"afmformats cannot read it ({_reason(error, copy)})", remedy=remedy) from error
    if not tests:
        raise InputError("holds no force curve", remedy="export force-distance curves")
    return tests


def _unreadable(content: bytes) -> str:
    """Return what keeps a file from being read within bounds; empty where nothing does.

    It may state more than it holds. An HDF5 file is read once in a process of its own; a member of an archive is never
    read beyond the length that it states.
    """
    if content.startswith(HDF5):
        return problem_of(content)
    if content.startswith(ZIP):
        try:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                stated = sum(member.file_size for member in archive.infolist())
        except zipfile.BadZipFile as error:
            return type(error).__name__
        return BEYOND if stated > MEMORY else ""
    return ""


def _test(source: Source, number: int, curve: Any) -> VendorTest:
    """Return one curve of ``afmformats`` as a test."""
    stiffness = float(curve.metadata.get("spring constant", 0.0))
    if not stiffness > 0:
        raise not_stated("spring constant")
    names = [name for name in HEIGHTS if name in curve]
    missing = ["height"] * (not names) + ["force"] * ("force" not in curve)
    if missing:
        raise InputError(f"lacks {' and '.join(missing)}", remedy="export it calibrated")
    force, height = np.asarray(curve["force"]), np.asarray(curve[names[0]])
    time, messages = (np.asarray(curve["time"]), ()) if "time" in curve else _time(source, len(force))
    depth = -1e9 * (height + force / stiffness)
    kept, warnings = usable(f"curve {number}", time, force, depth)
    time, force, depth = time[kept], force[kept], depth[kept]
    if names[0] != HEIGHTS[0]:
        messages = (*messages, BY_PIEZO)
    facts = {str(key): str(value) for key, value in curve.metadata.items() if key != "path"}
    channels = time - time[0], 1e3 * force, depth - depth[0]
    return vendor_test(source, str(number), channels, facts, (*warnings, *messages))


def _time(source: Source, count: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the times [s] of the `count` points of an Igor wave, which has no column of them."""
    if not is_wave(source.content):
        raise InputError("lacks time", remedy="export it with time")
    step, messages = sampling(source.content)
    return step * np.arange(count), messages


def not_stated(*names: str) -> InputError:
    """Return the error of a curve whose deflection is no force."""
    return InputError(f"states no {' and no '.join(names)}, so that its deflection is no load", remedy=UNCALIBRATED)


def _reason(error: BaseException, copy: Path) -> str:
    """Return in one line why the library cannot read a file; why it knows no format of JPK's its loader says."""
    from afmformats import errors
    from afmformats.formats.fmt_jpk import load_jpk

    if isinstance(error, KeyError) and error.args:
        return f"it states no {error.args[0]}"
    said = ""
    if not isinstance(error, errors.FileFormatNotSupportedError):
        said = str(error)
    elif copy.suffix in JPK_ENDINGS:
        try:
            load_jpk(copy)
        except Exception as reason:
            said = str(reason)
    said = " ".join(said.split())[:SHORT]
    return f"{type(error).__name__}: {said}" if said else type(error).__name__


@contextmanager
def _silence() -> Iterator[None]:
    """Keep the libraries from printing what they meet; the caller says it in one line."""
    loggers = [logging.getLogger(name) for name in ("afmformats", "igor2")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


READER = Reader("afm", "AFM force curve (JPK, Igor, HDF5, tab; by afmformats)", matches, read)
