"""The lines of a text: found at once, in its bytes, and read and decoded when they are asked for."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import BinaryIO, overload

import numpy as np

from indentation_files.errors import InputError

BLOCK = 1 << 22  # bytes that are looked at together
MOST = 3_000_000  # lines that are read one by one; more take more than a minute and 1 GB of memory
POSITION = np.int32  # of a byte: files have at most 2^29
BREAK = re.compile(r"\r\n|\r|\n")
PLAIN, LF, CR, OTHER = range(4)
KINDS = bytes(
    {**dict.fromkeys(b"0123456789+-.,eE;| \t", PLAIN), 10: LF, 13: CR}.get(byte, OTHER) for byte in range(256)
)


@dataclass(frozen=True, eq=False)
class Lines(Sequence[str]):
    """Lines of a text, whatever ends them.

    The text's bytes are in the `stream`; by its `encoding` each byte that breaks a line is one in ASCII. `starts` (n +
    1,) says where each line begins, and where the last one ends. `worded` are the numbers, from 0, of the lines that
    hold more than digits, signs and what parts numbers; `first` is that of the first line in the file, from 1, for
    messages.
    """

    stream: BinaryIO
    encoding: str
    starts: np.ndarray
    worded: np.ndarray
    first: int = 1

    @classmethod
    def of(cls, stream: BinaryIO, encoding: str, begin: int = 0, last: int = 0) -> Lines:
        """Return the lines of a `stream` in an `encoding`, from the byte at `begin` up to the `last`."""
        starts, worded, count = [np.array([begin], POSITION)], [], 0
        while begin < last:
            end = min(begin + BLOCK, last)
            end += piece(stream, end - 1, end + 1) == b"\r\n"
            kinds = np.frombuffer(piece(stream, begin, end).translate(KINDS), np.uint8)
            places = np.flatnonzero(kinds)
            found = kinds[places]
            before_lf = (found[:-1] == CR) & (found[1:] == LF) & (np.diff(places) == 1)
            ends = (found == LF) | ((found == CR) & ~np.append(before_lf, False)) if len(found) else found == LF
            worded.append(count + _each_once((np.cumsum(ends) - ends)[found == OTHER]))
            starts.append((begin + places[ends] + 1).astype(POSITION))
            begin, count = end, count + int(ends.sum())
        starts.append(np.array([last], POSITION))
        return cls(stream, encoding, np.concatenate(starts), _each_once(np.concatenate([np.empty(0, int), *worded])))

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, wanted: int) -> str: ...

    @overload
    def __getitem__(self, wanted: slice) -> Lines: ...

    def __getitem__(self, wanted: int | slice) -> str | Lines:
        if isinstance(wanted, slice):
            first, last, _ = wanted.indices(len(self))
            last = max(first, last)
            among = slice(*np.searchsorted(self.worded, (first, last)))
            starts, worded = self.starts[first : last + 1], self.worded[among] - first
            return replace(self, starts=starts, worded=worded, first=self.first + first)
        number = range(len(self))[wanted]
        return BREAK.sub("", self.written(number, number + 1).decode(self.encoding))

    def __iter__(self) -> Iterator[str]:
        for first, last in self.blocks():
            yield from BREAK.split(self.written(first, last).decode(self.encoding))[: last - first]

    def written(self, first: int, last: int) -> bytes:
        """Return the bytes of the lines from the `first` up to the `last`."""
        return piece(self.stream, int(self.starts[first]), int(self.starts[last]))

    def one_by_one(self) -> list[str]:
        """Return all lines; raises `InputError` where these are too many."""
        if len(self) > MOST:
            raise InputError(f"holds more than {MOST} lines", remedy="thin it, or export fewer tests at once")
        return list(self)

    def blocks(self) -> Iterator[tuple[int, int]]:
        """Yield the first line, and that after the last, of each block of lines."""
        first = 0
        while first < len(self):
            last = int(np.searchsorted(self.starts, POSITION(self.starts[first] + BLOCK), side="right")) - 1
            last = min(max(last, first + 1), len(self))
            yield first, last
            first = last

    def in_words(self) -> Iterator[tuple[int, str]]:
        """Yield the lines that are more than numbers, as any with a name is, and their numbers from 0."""
        return ((int(number), self[int(number)]) for number in self.worded)


def piece(stream: BinaryIO, begin: int, end: int) -> bytes:
    """Return the bytes of a stream from one position up to another."""
    stream.seek(begin)
    return stream.read(end - begin)


def _each_once(numbers: np.ndarray) -> np.ndarray:
    """Return each of some numbers (n,) in ascending order once."""
    return numbers[np.diff(numbers, prepend=-1) > 0]
