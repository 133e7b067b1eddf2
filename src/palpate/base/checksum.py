"""By what two things are known to be the same: a checksum of bytes, and one of what decides an object."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from numbers import Real
from pathlib import Path
from typing import Any

DIGITS = 64  # of a checksum, hexadecimal


def checksum(*parts: bytes | Path) -> str:
    """Return the SHA-256 of bytes or of a file, as ``sha256sum`` prints it; of several, that of all their checksums."""
    each = [_sha256(part) for part in parts]
    return each[0] if len(each) == 1 else hashlib.sha256("".join(each).encode()).hexdigest()


def _sha256(part: bytes | Path) -> str:
    if isinstance(part, bytes):
        return hashlib.sha256(part).hexdigest()
    with part.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def content_checksum(value: Any) -> str:
    """Return the checksum of what decides an object, see `content`."""
    return checksum(json.dumps(content(value), sort_keys=True).encode())


def content(value: Any) -> Any:
    """Return what decides an object in terms of JSON, from every field of a dataclass that its constructor takes.

    Fields that a dataclass derives from others are left out, and names, which it does not compare. Numbers become
    floats, which JSON writes with the fewest digits that restore them, in every version of Python and under every
    locale.

    Raises
    ------
    TypeError
        For a kind of value that it does not know, rather than let two of them look the same.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {
            type(value).__name__: {
                f.name: content(getattr(value, f.name)) for f in fields(value) if f.init and f.compare
            }
        }
    if isinstance(value, Mapping):
        return {str(key): content(item) for key, item in value.items()}
    if hasattr(value, "tolist"):  # an array
        return content(value.tolist())
    if isinstance(value, list | tuple):
        return [content(item) for item in value]
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Real):
        return float(value) + 0.0  # a negative zero is zero
    raise TypeError(f"{type(value).__name__} has no content that a checksum could rest on")
