"""What to say of a file that no reader knows: what it seems to be, and what its owner can do."""

from __future__ import annotations

import codecs
import re

from indentation_files.errors import InputError
from indentation_files.readers.igor import may_be_wave
from indentation_files.readers.source import PADDING, Source

LIST = "`palpate read --formats` lists formats and units"
BY_COLUMNS = "name the columns of its table (--columns time=...,load=...,depth=...); " + LIST
AS_TEXT = "export its tests as text; " + LIST
FORCE_CURVE = "export the force curve as text with time, force and separation"
NANOSCOPE = re.compile(rb"[\\?]\*(force )?file list", re.IGNORECASE)
TDM = re.compile(rb"\s*<\?xml[^>]*>\s*<usi:tdm", re.IGNORECASE)
KINDS = {
    b"TDSm": ("a TDMS file", AS_TEXT),
    b"GWYP": ("a Gwyddion file", AS_TEXT),
    b"[DataSet]": ("a Nanosurf file", AS_TEXT),
    b"II*\0": ("a TIFF image", AS_TEXT),
    b"MM\0*": ("a TIFF image", AS_TEXT),
    b"<?xml": ("an XML file", "save it as a workbook (.xlsx) or as text; " + LIST),
    **dict.fromkeys(
        (b"<html", b"<table", b"<!doctype html"), ("an HTML page", "save it as a workbook (.xlsx) or as text; " + LIST)
    ),
}
CONTROLS = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a\x1b"))
MOST_CONTROLS = 0.02  # of a text's bytes, chosen: those of random numbers have a tenth


def no_table(source: Source) -> tuple[str, str] | None:
    """Return what a file is that holds neither text nor a workbook, and what its owner can do; None for others."""
    begun = source.begun
    if source.container:
        return source.container, f"unpack it, or {AS_TEXT}"
    if source.workbook or source.wide:
        return None
    if NANOSCOPE.match(begun) and b"\0" in source.content:
        return "a NanoScope file, which the library afmformats does not read either", FORCE_CURVE
    if may_be_wave(begun):
        return "an Igor wave that is cut off, or has no note on a cantilever", f"copy it again, or {FORCE_CURVE}"
    if TDM.match(begun):
        return "the header of a TDM file, whose numbers lie in the .tdx file beside it", AS_TEXT
    first = begun.removeprefix(codecs.BOM_UTF8).lstrip()
    kind = next((words for magic, words in KINDS.items() if first[: len(magic)].lower() == magic.lower()), None)
    begun = begun.rstrip(PADDING)
    binary = len(begun) - len(begun.translate(None, CONTROLS)) > MOST_CONTROLS * len(begun)
    return kind or (("a binary file", AS_TEXT) if binary else None)


def unknown(source: Source) -> InputError:
    """Return the error of a file of no known format: of a kind that holds no table, or a text."""
    known = no_table(source)
    if known:
        return InputError(f"is of no format that palpate knows: {known[0]}", remedy=known[1], file=source.path)
    first = " ".join(source.first.split())
    begins = f"; its first line is {first[:60]!r}" if first.isprintable() and first else ""
    return InputError(f"is of no format that palpate knows{begins}", remedy=BY_COLUMNS, file=source.path)
