"""A study's file held against its declaration: one clear line for the first mistake.

Keys that exclude each other are refused, too.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError

from palpate.base.parameters import is_finite_number
from palpate.configuration.declaration import REFUSED
from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError
from palpate.study.protocol import DISPLACEMENT

REFERENCE = "docs/study.md"
KINDS = {
    "bool_type": "true or false",
    "dict_type": "a table of keys",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "model_type": "a table of keys",
    "string_type": "text (in quotes where it looks like a number)",
    "list_type": "a list",
}
LIMITS = {
    "greater_than": "more than {gt:g}",
    "greater_than_equal": "{ge:g} or more",
    "less_than": "less than {lt:g}",
    "less_than_equal": "{le:g} or less",
}
LENGTHS = {"too_short": "{min_length} or more", "too_long": "{max_length} or fewer"}
LONGEST = 60  # letters of a value in a message
WITHOUT_LENGTH = ("cubic", "linear")  # kernels of which a length changes the weights, and not the interpolant
NUMBERED = ("source", "contact")  # a table whose keys may be numbers, those of tests
UNKNOWN, MISSING = "extra_forbidden", "missing"  # types of errors of a key
OF_A_KEY = "[key]"  # last part of a place, where not the value but its key is wrong


def checked_file(values: Any) -> StudyFile:
    """Return what a study's file holds, with all defaults.

    Raises
    ------
    InputError
        For the first thing that is not allowed, with its place and a remedy; unknown keys are reported before missing
        ones, which they may be meant for.
    """
    for path, name in _keys(values):
        if not isinstance(name, str) and path != NUMBERED:
            problem = f"the key {json.dumps(name, default=str)} is no text"
            raise InputError(problem, remedy="put it in quotes", place=_place(path) or "top level")
    for path, value in _nodes(values):
        if isinstance(value, int | float) and not isinstance(value, bool) and not is_finite_number(value):
            problem = f"{str(value)[:LONGEST]} is given, expected a number"
            raise InputError(problem, remedy="correct it", place=_place(path))
    try:
        return StudyFile.model_validate(values)
    except ValidationError as error:
        raise _first_problem(error) from None


def _first_problem(error: ValidationError) -> InputError:
    """Return the line for the first mistake by place."""
    problems = [(_path(each), each) for each in error.errors(include_url=False)]
    path, first = min(problems, key=lambda each: ([str(part) for part in each[0]], each[1]["type"] != UNKNOWN))
    place, facts = _place(path), first.get("ctx", {})
    declared, remedy = _declared(path)
    if first["type"] == UNKNOWN:
        key, known = str(first["loc"][-1]), list(declared.model_fields)
        place = f"{place}.{key}".lstrip(".")
        if key in declared.removed:
            return InputError(f"{key} was removed: {declared.removed[key]}", remedy="take it out", place=place)
        problem = f"unknown key {key!r}{suggestion(key, known)}"
        return InputError(problem, remedy=f"use one of: {', '.join(known)}", place=place)
    if first["type"] == REFUSED:
        place = ".".join(filter(None, (place, facts["place"])))
        return InputError(facts["problem"], remedy=facts["remedy"], place=place)
    section = next(iter(path), "the keys")
    problem = _problem(first["type"], facts, first["input"], first["loc"], declared)
    return InputError(problem, remedy=remedy or f"see {section} in {REFERENCE}", place=place or "top level")


def _path(error: Mapping[str, Any]) -> tuple[str | int, ...]:
    """Return the place of an error: of a key that is missing or not known, that of its table."""
    at: tuple[str | int, ...] = error["loc"]
    if at and at[-1] == OF_A_KEY:
        return at[:-2]
    return at[:-1] if error["type"] in (UNKNOWN, MISSING) else at


def _problem(kind: str, facts: Mapping[str, Any], given: Any, at: tuple[str | int, ...], declared: Any) -> str:
    """Return in a sentence what the declaration does not allow."""
    if kind == MISSING:
        return f"the key {at[-1]!r} is missing"
    value = "nothing" if given is None else json.dumps(given, default=str, ensure_ascii=False, skipkeys=True)
    value = value if len(value) <= LONGEST else f"{value[:LONGEST]} ..."
    if kind in KINDS:
        return f"{value} is given, expected {KINDS[kind]}"
    if kind == "literal_error":
        return f"{value} is given, expected one of: {', '.join(get_args(declared))}"
    if kind in LIMITS:
        return f"{value} is given, expected {LIMITS[kind].format(**facts)}"
    if kind in LENGTHS:
        return f"{len(given)} entries are given, expected {LENGTHS[kind].format(**facts)}"
    return f"{value} names something twice" if kind == "not_unique" else f"{value} is not allowed"


def _declared(path: Iterable[str | int]) -> tuple[Any, str]:
    """Return the type that is declared at a place, and the remedy for it."""
    kind: Any = StudyFile
    remedy = ""
    for part in path:
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            field = kind.model_fields[str(part)]
            extra = field.json_schema_extra
            kind, remedy = field.annotation, str(extra.get("remedy", "")) if isinstance(extra, dict) else ""
        else:
            kind = get_args(kind)[1 if get_origin(kind) is dict else 0]
        kind = bare(kind)
    return kind, remedy


def bare(kind: Any) -> Any:
    """Return a declared type without its annotations, and without the None of what may be left out."""
    while get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    others = [each for each in get_args(kind) if each is not type(None)]
    optional = len(others) < len(get_args(kind)) and get_origin(kind) is not Literal
    return bare(others[0]) if optional else kind


def _place(path: Iterable[str | int]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).lstrip(".")


def _keys(values: Any) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Yield every key with the place of its table."""
    for path, table in _nodes(values):
        if isinstance(table, Mapping):
            yield from ((path, key) for key in table)


def _nodes(values: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Yield every table, list and value with its place."""
    yield path, values
    if isinstance(values, Mapping | list):
        entries = values.items() if isinstance(values, Mapping) else enumerate(values)
        for key, value in entries:
            yield from _nodes(value, (*path, key))


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return a question that names the known word nearest to a misspelt one; nothing where none is near."""
    near = difflib.get_close_matches(str(word), list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def check_contradictions(study: StudyFile) -> None:
    """Refuse keys that another key makes ineffective; raises `InputError`."""
    design, surrogate, challenge = study.design, study.surrogate, study.challenge
    if "points" in design.model_fields_set and design.kind != "sobol":
        raise InputError(
            "points applies to kind: sobol alone", remedy="add kind: sobol, or leave points out",
            place="design.points",
        )  # fmt: skip
    if "energy" in surrogate.model_fields_set and surrogate.n_modes is not None:
        raise InputError("energy has no effect beside n_modes", remedy="keep one of them", place="surrogate.energy")
    if surrogate.kernel in WITHOUT_LENGTH and is_finite_number(surrogate.shape):
        raise InputError(
            f"a length has no effect on the kernel {surrogate.kernel}", remedy="leave it out, or give loo_each",
            place="surrogate.shape",
        )  # fmt: skip
    if len(challenge.mechanisms) == 1 and challenge.two:
        raise InputError(
            "one mechanism alone gives no case with two effects", remedy="name more, or give two: 0",
            place="challenge.mechanisms",
        )  # fmt: skip
    if study.diagnosis.reference and all(
        entry.drive == DISPLACEMENT or entry.role == "validate" for entry in study.conditions
    ):
        raise InputError(
            "it is compared with the unloadings of fitted tests under load control, of which there are none",
            remedy="leave it out", place="diagnosis.reference",
        )  # fmt: skip
