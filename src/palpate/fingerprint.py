"""What a result rests on, for a hash: an object's content, and source code less comments, layout and docstrings."""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

PHYSICS = (
    "fem",
    "fem3d",
    "area_function.py",
    "materials",
    "mechanisms",
    "indenters.py",
    "interpolation.py",
    "protocol.py",
    "specification.py",
    "specimen.py",
    "displaced.py",
    "variation.py",
    "model.py",
)


@functools.cache
def fingerprint(*parts: str) -> str:
    """Return a hash of the code of some of the package's modules and folders.

    Parameters
    ----------
    parts
        Paths within the package, such as ``fem`` or ``model.py``.
    """
    root = Path(__file__).parent
    digest = hashlib.sha256()
    for part in parts:
        files = [root / part] if part.endswith(".py") else sorted((root / part).rglob("*.py"))
        for file in files:
            tree = without_docstrings(ast.parse(file.read_text(encoding="utf-8")))
            digest.update(f"{file.relative_to(root)}\n{ast.dump(tree)}".encode())
    return digest.hexdigest()


def without_docstrings(tree: ast.AST) -> ast.AST:
    """Return a syntax tree less the docstrings of its module, classes and functions (changed in place)."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if (
            isinstance(body, list)
            and body
            and isinstance(body[0], ast.Expr)
            and isinstance(body[0].value, ast.Constant)
        ):
            node.body = body[1:]  # type: ignore[attr-defined]
    return tree


def content(value: Any) -> Any:
    """Return what decides an object in terms of JSON, from every field of a dataclass that its constructor takes.

    Fields that a dataclass derives from others are left out. Numbers become floats, which JSON writes with the fewest
    digits that restore them, in every version of Python and under every locale.

    Raises
    ------
    TypeError
        For a kind of value that it does not know, rather than let two of them look the same.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {type(value).__name__: {f.name: content(getattr(value, f.name)) for f in fields(value) if f.init}}
    if isinstance(value, Mapping):
        return {str(key): content(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return content(value.tolist())
    if isinstance(value, list | tuple):
        return [content(item) for item in value]
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Real):
        return float(value) + 0.0  # a negative zero is zero
    raise TypeError(f"{type(value).__name__} has no content that a hash could rest on")
