"""What a result rests on, for a hash: an object's content, and source code with all that it imports.

Of source code the hash sees names, numbers and structure; comments, layout and docstrings change nothing. It is the
same under every version of Python that runs this package.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import io
import tokenize
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

SOURCE = Path(__file__).parents[2]
DECIDE_NOTHING = ("palpate", "palpate.errors", "palpate.base.kernel_cache", "palpate.base.threads")
LAYOUT = (tokenize.COMMENT, tokenize.NL, tokenize.ENCODING, tokenize.ENDMARKER)
NESTED = {getattr(tokenize, "FSTRING_START", -1): 1, getattr(tokenize, "FSTRING_END", -1): -1}
Position = tuple[int, int]


@functools.cache
def fingerprint(*start: str | Path) -> str:
    """Return a hash of some modules and of everything of the same packages that they import, directly or not.

    Parameters
    ----------
    start
        Names of modules, such as ``palpate.solver.simulation``, or files of scripts.
    """
    digest = hashlib.sha256()
    for file in sorted(closure(*start), key=lambda file: (file.name, str(file))):
        digest.update(f"{file.name} {_identity(file)}\n".encode())
    return digest.hexdigest()


@functools.cache
def _identity(file: Path) -> str:
    """Return a hash of the code in one file."""
    return hashlib.sha256(canonical(file.read_text(encoding="utf-8")).encode()).hexdigest()


def closure(*start: str | Path) -> set[Path]:
    """Return the files of modules and of everything of this package, and beside it, that they import."""
    found: set[Path] = set()
    pending = [_file(each) if isinstance(each, str) else each for each in start]
    while pending:
        file = pending.pop()
        if file is not None and file not in found:
            found.add(file)
            pending += imported(file)
    return found


@functools.cache
def imported(file: Path) -> list[Path]:
    """Return the files of the modules that a file imports, and of those among which it discovers members."""
    tree, found = ast.parse(file.read_text(encoding="utf-8")), list[Path | None]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [_file(alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            members = [_file(f"{node.module}.{alias.name}") for alias in node.names]
            found += [member or _file(node.module) for member in members]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "discover":
            found += sorted(file.parent.glob("*.py"))
    return [each for each in found if each is not None]


@functools.cache
def _file(module: str) -> Path | None:
    """Return the file of a module that lies in this package's folder or in the repository, if its code decides."""
    if module in DECIDE_NOTHING:
        return None
    for root in (SOURCE, SOURCE.parent):
        path = root.joinpath(*module.split("."))
        for file in (path.with_suffix(".py"), path / "__init__.py"):
            if file.is_file():
                return file
    return None


def canonical(source: str) -> str:
    """Return source code less comments, layout and docstrings."""
    docstrings, parts, follows = _docstrings(ast.parse(source)), list[str](), False
    lines, depth, began = source.splitlines(keepends=True), 0, (0, 0)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in LAYOUT:
            continue
        if token.type == tokenize.STRING and token.start in docstrings:
            follows = True
        elif token.type in NESTED:
            began = token.start if depth == 0 else began
            depth += NESTED[token.type]
            if depth == 0:
                parts.append(_between(lines, began, token.end))
        elif depth == 0 and not (follows and token.type == tokenize.NEWLINE):
            layout = token.type in (tokenize.INDENT, tokenize.DEDENT, tokenize.NEWLINE)
            parts.append(tokenize.tok_name[token.type] if layout else token.string)
            follows = False
    return "\n".join(parts)


def _between(lines: list[str], first: Position, last: Position) -> str:
    """Return the text between two positions: lines from 1, columns from 0."""
    chosen = lines[first[0] - 1 : last[0]]
    chosen[-1] = chosen[-1][: last[1]]
    chosen[0] = chosen[0][first[1] :]
    return "".join(chosen)


def _docstrings(tree: ast.AST) -> set[Position]:
    """Return where the docstrings of a module, its classes and functions begin."""
    found = set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        first = body[0] if isinstance(body, list) and body else None
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
            found.add((first.lineno, first.col_offset))
    return found


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
