"""How the keys of a study's file are declared: a type with its limits, a default, what the key means.

A table of keys is a subclass of `Section`; its attributes are the keys, each declared once by `key`. What a file gives
is checked against it (`palpate.configuration.checked_file`), the defaults are filled in, and docs/study.md lists it.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from palpate.base.yaml_file import EXPONENT

REFUSED = "refused"  # type of an error besides those of the library


def refused(problem: str, remedy: str, place: str = "") -> PydanticCustomError:
    """Return the error of a value, or of a table, with what to do and, of a table, the place within it."""
    return PydanticCustomError(REFUSED, "{problem}", {"problem": problem, "remedy": remedy, "place": place})


class Section(BaseModel):
    """A table of keys: unknown ones are refused, no type is taken for another, and nothing changes later."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)
    removed: ClassVar[dict[str, str]] = {}  # keys that there were once, and what to know of each


def key(meaning: str, default: Any = ..., *, accepted: str = "", remedy: str = "", **limits: Any) -> Any:
    """Declare a key.

    Parameters
    ----------
    meaning
        For docs/study.md (Markdown).
    default
        Of a key that may be left out; others are required.
    accepted
        What it takes, for docs/study.md, where type and limits do not say it.
    remedy
        What to do where a value is refused; without it the message names docs/study.md.
    limits
        Such as `ge` and `lt` of a number, `pattern` of a text, `min_length` of a list.
    """
    return Field(default, description=meaning, json_schema_extra={"accepted": accepted, "remedy": remedy}, **limits)


def _number(given: Any) -> Any:
    """Return what is written as 1e9 as a number; Snakemake's command line reads it as text."""
    return float(given) if isinstance(given, str) and EXPONENT.match(given) else given


def _whole(given: Any) -> Any:
    """Return a whole number as an integer, however it is written."""
    given = _number(given)
    return int(given) if isinstance(given, float) and given.is_integer() else given


def numbers_within(given: Any) -> Any:
    """Return what a table or list of free form holds, with `_number` of each text in it."""
    if isinstance(given, dict):
        return {name: numbers_within(value) for name, value in given.items()}
    return [numbers_within(value) for value in given] if isinstance(given, list) else _number(given)


Number = Annotated[float, BeforeValidator(_number)]
Whole = Annotated[int, BeforeValidator(_whole)]
Pair = Annotated[list[Number], Field(min_length=2, max_length=2)]
