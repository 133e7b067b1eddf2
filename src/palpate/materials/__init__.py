"""Constitutive laws: every module of this folder that defines ``LAW`` is found by itself."""

from indentation_files.discovery import discover
from palpate.base import kernel_cache
from palpate.errors import InputError
from palpate.materials.joined import joined
from palpate.materials.law import Law

kernel_cache.require()

LAWS: dict[str, Law] = {law.key: law for law in discover(__name__, __path__, "LAW")}
ELASTIC = LAWS["elastic"]

__all__ = ["LAWS", "Law", "law_of"]


def law_of(model: object) -> Law:
    """Return the law of a `model`: one of `LAWS`, or several joined by ``+`` in any order.

    Raises
    ------
    InputError
        When a law is not known, is none by itself, or cannot be joined to another.
    """
    law = LAWS[str(model)] if model in LAWS else _joined(str(model))
    law.check_together()
    return law


def _joined(model: str) -> Law:
    """Return the law of a `model` of several parts; raises `InputError`."""
    names = [name.strip() for name in model.split("+")]
    for name in names:
        if name not in LAWS:
            raise InputError(
                f"material model {name!r} is not known",
                remedy=f"use one of: {', '.join(LAWS)}; or several joined by +",
                place="model",
            )
    parts = [part for name in names for part in LAWS[name].parts if part != ELASTIC.key] or [ELASTIC.key]
    twice = next((part for part in parts if parts.count(part) > 1), None)
    if twice:
        raise InputError(f"{model} holds {twice} twice", remedy="name it once", place="model")
    known = {law.parts: law for law in LAWS.values()}
    return known.get(tuple(sorted(parts))) or joined([LAWS[part] for part in parts])
