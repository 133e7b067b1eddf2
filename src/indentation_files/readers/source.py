"""A vendor's file, opened as bytes, as lines of text or as a workbook, whichever its reader asks for.

A long text is read in blocks, as often as needed, and never held whole.
"""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

from indentation_files.bounded_process import Workbook, read_workbook
from indentation_files.errors import InputError
from indentation_files.readers.lines import BLOCK, Lines, piece

OLE, ZIP, HDF5 = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"PK\x03\x04", b"\x89HDF\r\n"
IN_WORKBOOKS = (b"xl/workbook", b"xl/worksheets", b"opendocument.spreadsheet")
IN_OTHERS = (b"word/document", b"ppt/presentation", b"header.properties")
BEGINNING = 100_000  # bytes by which a file is judged
FIRST_NAME = 200  # bytes of a zip archive that hold the name of its first part
CONTAINERS = {ZIP: "a zip archive", HDF5: "an HDF5 file"}
TEST = re.compile(r"t(?:est)?[ _#.-]*(\d+)(?![^\W_])", re.IGNORECASE)
PADDING = b"\0\x1a"
WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
WIDEST = (codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)  # the first begins as UTF-16's does


@dataclass(frozen=True)
class Source:
    """A vendor's file: where it lies, whose ending means nothing, and its bytes, open for reading."""

    path: Path
    stream: BinaryIO = field(repr=False)

    @property
    def content(self) -> bytes:
        """All bytes of the file."""
        return b"".join(self.blocks())

    def blocks(self) -> Iterator[bytes]:
        """Yield the bytes of the file in blocks."""
        self.stream.seek(0)
        return iter(lambda: self.stream.read(BLOCK), b"")

    @cached_property
    def begun(self) -> bytes:
        """The first bytes of the file."""
        return piece(self.stream, 0, BEGINNING)

    @cached_property
    def lines(self) -> Lines:
        """Lines of text, whatever ends them; a workbook has none.

        UTF-32 where it is marked, UTF-16 where it is marked or every other byte is zero, UTF-8 where that fits, Latin-1
        otherwise. What pads the end of the file (zero bytes, DOS's end of text) is dropped.
        """
        if self.begun.startswith((OLE, ZIP, HDF5)):
            return Lines.of(io.BytesIO(), "utf-8")[:0]
        anew = io.BytesIO()
        try:
            for text in self._decoded():
                if self.wide:
                    anew.write(text.encode())
        except UnicodeDecodeError:
            return Lines.of(self.stream, "latin-1", 0, _filled(self.stream))
        stream = anew if self.wide else self.stream
        marked = piece(stream, 0, len(codecs.BOM_UTF8)) == codecs.BOM_UTF8
        return Lines.of(stream, "utf-8", len(codecs.BOM_UTF8) if marked else 0, _filled(stream))

    def _decoded(self) -> Iterator[str]:
        """Yield the text by the encoding that its first bytes speak for; raises `UnicodeDecodeError`."""
        decoder = codecs.getincrementaldecoder(self._encoding)()
        yield from map(decoder.decode, self.blocks())
        yield decoder.decode(b"", final=not self.wide)  # a wide text may be cut off within a letter

    @property
    def _encoding(self) -> str:
        """The encoding that the first bytes speak for."""
        if self.begun.startswith(WIDEST):
            return "utf-32"
        if self.begun.startswith(WIDE):
            return "utf-16"
        first, second, third, fourth = self.begun[:4].ljust(4, b"x")
        if first and third and not second and not fourth:
            return "utf-16-le"
        if second and fourth and not first and not third:
            return "utf-16-be"
        return "utf-8"

    @property
    def wide(self) -> bool:
        """Whether the text takes two bytes a letter, or four."""
        return self._encoding.startswith(("utf-16", "utf-32"))

    @cached_property
    def first(self) -> str:
        """The first line that holds more than blanks; empty where there is none."""
        return next((line.strip() for line in self.lines if line.strip()), "")

    @cached_property
    def workbook(self) -> bool:
        """Whether the file is an Excel or OpenDocument workbook, be it damaged, by its bytes."""
        if not self.begun.startswith(ZIP):
            return self.begun.startswith(OLE)
        content = self.content
        of_office = content[:FIRST_NAME].find(b"[Content_Types].xml") >= 0
        return any(part in content for part in IN_WORKBOOKS) or (
            of_office and not any(part in content for part in IN_OTHERS)
        )

    @property
    def container(self) -> str:
        """What kind of container of other files or tables this is, in words; empty for text and workbooks."""
        if self.workbook:
            return ""
        return next((kind for magic, kind in CONTAINERS.items() if self.begun.startswith(magic)), "")

    @property
    def sheets(self) -> list[str]:
        """Names of a workbook's sheets that are shown; empty for another file; raises `InputError` on a damaged one."""
        return [name for name in (*self._cells.sheets, *self._cells.damaged) if name not in self._cells.hidden]

    @property
    def hidden(self) -> list[str]:
        """Names of the workbook's sheets that are not shown."""
        return self._cells.hidden

    def sheet(self, name: str) -> list[list[Any]]:
        """Return the rows of a sheet, empty for another file; raises `InputError` when it is damaged."""
        return self.placed_sheet(name)[1]

    def placed_sheet(self, name: str) -> tuple[int, list[list[Any]]]:
        """Return the rows of a sheet from the first that holds anything, and the number of that row, from 1."""
        if name in self._cells.damaged:
            raise InputError(
                f"is damaged ({self._cells.damaged[name]})", remedy="copy or export it again", file=self.path,
                place=f"sheet {name}",
            )  # fmt: skip
        first, _, rows = self._cells.sheets.get(name, (1, 1, []))
        return first, rows

    def empty_before(self, name: str) -> int:
        """Return how many empty columns come before the first cell of a sheet's rows."""
        return self._cells.sheets[name][1] - 1 if name in self._cells.sheets else 0

    @cached_property
    def _cells(self) -> Workbook:
        """The cells of all sheets; raises `InputError` on a workbook that is damaged."""
        found = read_workbook(self.content) if self.workbook else Workbook()
        if found.problem:
            problem = f"is no whole Excel workbook ({found.problem})"
            raise InputError(problem, remedy="copy or export it again, or as text", file=self.path)
        return found


def _filled(stream: BinaryIO) -> int:
    """Return where what pads the end of a file begins."""
    end = stream.seek(0, io.SEEK_END)
    while end:
        begin = max(end - BLOCK, 0)
        kept = piece(stream, begin, end).rstrip(PADDING)
        if kept:
            return begin + len(kept)
        end = begin
    return 0


def number_of(name: str) -> int | None:
    """Return the number of a sheet such as ``Test 010``, ``TEST 010`` or ``T010``, or None for another name."""
    found = TEST.match(name)
    return int(found[1]) if found else None


def numbers_of(names: Sequence[str]) -> list[int]:
    """Return the number of each test: its own where no other has it too, else counted from 1."""
    own = [number_of(name) for name in names]
    return [number if number and own.count(number) == 1 else count for count, number in enumerate(own, 1)]
