"""What a YAML file holds against a JSON schema: one clear line for the first mistake, and the defaults filled in.

Keys that exclude each other are refused, too.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Iterator, Mapping
from importlib import resources
from typing import Any

import jsonschema

from palpate.base.parameters import is_finite_number
from palpate.errors import InputError
from palpate.study.protocol import DISPLACEMENT

REFERENCE = "docs/study.md"
TYPES = {
    "array": "a list",
    "boolean": "true or false",
    "integer": "a whole number",
    "null": "null",
    "number": "a number",
    "object": "a table of keys",
    "string": "text (in quotes where it looks like a number)",
}
PROBLEMS = {
    "type": "{value} is given, expected {wanted}",
    "enum": "{value} is given, expected {wanted}",
    "pattern": "{value} is not allowed",
    "anyOf": "{value} is not allowed",
    "oneOf": "{value} is not allowed",
    "uniqueItems": "{value} names something twice",
    "minimum": "{value} is given, expected {wanted} or more",
    "maximum": "{value} is given, expected {wanted} or less",
    "exclusiveMinimum": "{value} is given, expected more than {wanted}",
    "exclusiveMaximum": "{value} is given, expected less than {wanted}",
    "minItems": "{count} entries are given, expected {wanted} or more",
    "maxItems": "{count} entries are given, expected {wanted} or fewer",
    "minProperties": "{count} entries are given, expected {wanted} or more",
    "required": "the key {missing!r} is missing",
}
LONGEST = 60  # letters of a value in a message
WITHOUT_LENGTH = ("cubic", "linear")  # kernels of which a length changes the weights, and not the interpolant
NUMBERED = ("source", "contact")  # a table whose keys may be numbers, those of tests


def study_schema() -> dict[str, Any]:
    """Return the JSON schema of a study's file."""
    text = resources.files("palpate.configuration").joinpath("study.schema.json").read_text(encoding="utf-8")
    return dict(json.loads(text))


def check_schema(values: Any, schema: Mapping[str, Any]) -> None:
    """Check the content of a YAML file; unknown keys are reported before missing ones, which they may be meant for.

    Raises
    ------
    InputError
        For the first thing that the schema does not allow, with its place and a remedy.
    """

    def order(error: jsonschema.ValidationError) -> tuple[list[str], bool]:
        return list(map(str, error.path)), error.validator != "additionalProperties"

    for path, key in _keys(values):
        if not isinstance(key, str) and path != NUMBERED:
            problem = f"the key {json.dumps(key, default=str)} is no text"
            raise InputError(problem, remedy="put it in quotes", place=_place(path) or "top level")
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(values), key=order)
    if not errors:
        for path, value in _numbers(values):
            if not is_finite_number(value):
                problem = f"{str(value)[:LONGEST]} is given, expected a number"
                raise InputError(problem, remedy="correct it", place=_place(path))
        return
    error = errors[0]
    place = _place(error.absolute_path)
    if error.validator == "additionalProperties" and isinstance(error.instance, Mapping):
        known = error.schema.get("properties", {})
        key = next(key for key in error.instance if key not in known)
        place = f"{place}.{key}".lstrip(".")
        if gone := error.schema.get("removed", {}).get(key):
            raise InputError(f"{key} was removed: {gone}", remedy="take it out", place=place)
        problem = f"unknown key {key!r}{suggestion(key, known)}"
        raise InputError(problem, remedy=f"use one of: {', '.join(known)}", place=place)
    section = next(iter(error.absolute_path), "the keys")
    remedy = error.schema.get("description", f"see {section} in {REFERENCE}")
    raise InputError(_problem(error), remedy=remedy, place=place or "top level")


def _place(path: Iterable[str | int]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).lstrip(".")


def _numbers(values: Any) -> Iterator[tuple[tuple[str | int, ...], float]]:
    """Yield every number with its place."""
    for path, value in _nodes(values):
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield path, value


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


def _problem(error: jsonschema.ValidationError) -> str:
    """Return in a sentence what the schema does not allow."""
    found: Any = error.instance
    wanted: Any = error.validator_value
    kind = str(error.validator)
    if kind == "type":
        wanted = " or ".join(TYPES[name] for name in ([wanted] if isinstance(wanted, str) else wanted))
    elif kind == "enum":
        wanted = f"one of: {', '.join(wanted)}"
    value = "nothing" if found is None else json.dumps(found, default=str, ensure_ascii=False, skipkeys=True)
    value = value if len(value) <= LONGEST else f"{value[:LONGEST]} ..."
    count = len(found) if isinstance(found, list | dict) else 0
    missing = next((key for key in wanted if key not in found), None) if kind == "required" else None
    return PROBLEMS[kind].format(value=value, wanted=wanted, count=count, missing=missing)


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return a question that names the known word nearest to a misspelt one; nothing where none is near."""
    near = difflib.get_close_matches(str(word), list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def with_defaults(values: Mapping[str, Any], schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` with the defaults of the schema filled in, section by section; whole numbers become integers."""
    filled = dict(values)
    for key, rule in schema.get("properties", {}).items():
        if "integer" in rule.get("type", ()) and isinstance(values.get(key), float):
            filled[key] = int(values[key])
        if "default" in rule:
            filled.setdefault(key, rule["default"])
        elif rule.get("type") == "object" and (key in values or not rule.get("required")):
            inner = rule.get("additionalProperties")
            if isinstance(inner, Mapping) and inner.get("properties"):
                filled[key] = {name: with_defaults(entry, inner) for name, entry in values.get(key, {}).items()}
            elif rule.get("additionalProperties") is False:
                filled[key] = with_defaults(values.get(key, {}), rule)
    return filled


def check_contradictions(values: Mapping[str, Any]) -> None:
    """Refuse keys that another key makes ineffective; raises `InputError`."""
    design, surrogate, challenge = (values.get(name, {}) for name in ("design", "surrogate", "challenge"))
    if "points" in design and design.get("kind") != "sobol":
        raise InputError(
            "points applies to kind: sobol alone", remedy="add kind: sobol, or leave points out",
            place="design.points",
        )  # fmt: skip
    if "energy" in surrogate and surrogate.get("n_modes") is not None:
        raise InputError("energy has no effect beside n_modes", remedy="keep one of them", place="surrogate.energy")
    kernel, shape = surrogate.get("kernel"), surrogate.get("shape")
    if kernel in WITHOUT_LENGTH and is_finite_number(shape):
        raise InputError(
            f"a length has no effect on the kernel {kernel}", remedy="leave it out, or give loo_each",
            place="surrogate.shape",
        )  # fmt: skip
    if len(challenge.get("mechanisms", ())) == 1 and challenge.get("two") != 0:
        raise InputError(
            "one mechanism alone gives no case with two effects", remedy="name more, or give two: 0",
            place="challenge.mechanisms",
        )  # fmt: skip
    if "reference" in values.get("diagnosis", {}) and all(
        entry.get("drive") == DISPLACEMENT or entry.get("role") == "validate" for entry in values["conditions"]
    ):
        raise InputError(
            "it is compared with the unloadings of fitted tests under load control, of which there are none",
            remedy="leave it out", place="diagnosis.reference",
        )  # fmt: skip
