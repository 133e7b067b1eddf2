"""What a YAML file holds against a JSON schema: one clear line for the first mistake, and the defaults filled in."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

import jsonschema

from palpate.errors import InputError


def check_schema(values: Any, schema: Mapping[str, Any]) -> None:
    """Check what a YAML file holds.

    Raises
    ------
    InputError
        For the first thing that the schema does not allow, with its place and a remedy.
    """
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(values), key=lambda e: list(map(str, e.path)))
    if not errors:
        return
    error = errors[0]
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in error.absolute_path).lstrip(".")
    if error.validator == "additionalProperties" and isinstance(error.instance, Mapping):
        known = error.schema.get("properties", {})
        key = next(key for key in error.instance if key not in known)
        raise InputError(
            f"unknown key {key!r}{suggestion(key, known)}",
            remedy=f"use one of: {', '.join(known)}",
            place=f"{place}.{key}".lstrip("."),
        )
    problem = error.message if len(error.message) <= 160 else f"{error.message[:60]} ... {error.message[-90:]}"
    remedy = error.schema.get("description", "see the study configuration in the README")
    raise InputError(problem, remedy=remedy, place=place or "top level")


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return a question that names the known word nearest to a misspelt one; nothing where none is near."""
    near = difflib.get_close_matches(str(word), list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def with_defaults(values: Mapping[str, Any], schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` with the defaults of the schema filled in, section by section."""
    filled = dict(values)
    for key, rule in schema.get("properties", {}).items():
        if "default" in rule:
            filled.setdefault(key, rule["default"])
        elif rule.get("type") == "object" and (key in values or not rule.get("required")):
            inner = rule.get("additionalProperties")
            if isinstance(inner, Mapping) and inner.get("properties"):
                filled[key] = {name: with_defaults(entry, inner) for name, entry in values.get(key, {}).items()}
            elif rule.get("additionalProperties") is False:
                filled[key] = with_defaults(values.get(key, {}), rule)
    return filled
