"""Hashes of source code: a changed formula changes them; comments, layout and docstrings do not."""

from __future__ import annotations

import ast
import functools
import hashlib
from pathlib import Path

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
