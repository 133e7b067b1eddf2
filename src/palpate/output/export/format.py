"""What a format of `palpate export` declares: its key, and how a specification is written in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from palpate.errors import InputError
from palpate.study.specification import Specification


@dataclass(frozen=True)
class Format:
    """A finite element program's input.

    Parameters
    ----------
    key
        Name on the command line.
    write
        Writes a specification to a path; raises `InputError` for what the program cannot represent.
    """

    key: str
    write: Callable[[Specification, Path], None]


def check_exportable(specification: Specification) -> None:
    """Raise `InputError` when a specification has mechanisms, an elastic indenter or a pyramid: no deck holds them."""
    if specification.mechanisms:
        raise InputError("mechanisms cannot be exported", remedy="remove them", place="mechanisms")
    if not specification.indenter.of_revolution:
        raise InputError("a pyramid cannot be exported", remedy="use the equivalent cone", place="indenter.shape")
    if specification.indenter.compliance:
        raise InputError("an elastic indenter cannot be exported", remedy="remove modulus", place="indenter.modulus")
