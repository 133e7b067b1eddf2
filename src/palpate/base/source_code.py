"""What decides in one file of source code, and what it imports; remembered, because parsing takes long.

Names, numbers and structure decide; comments, layout and docstrings change nothing. What is found is the same under
every version of Python that runs this package.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import io
import json
import tokenize
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from indentation_files.whole_file import written_whole
from palpate.base import kernel_cache
from palpate.base.checksum import checksum

LAYOUT = (tokenize.COMMENT, tokenize.NL, tokenize.ENCODING, tokenize.ENDMARKER)
NESTED = {getattr(tokenize, "FSTRING_START", -1): 1, getattr(tokenize, "FSTRING_END", -1): -1}
Position = tuple[int, int]

_known: dict[str, Any] = {}  # what was found, by the checksum of a file and of this one


@dataclass(frozen=True)
class SourceCode:
    """What decides in one file, and what it imports.

    Attributes
    ----------
    identity
        Hash of what decides in it.
    imports
        Of each import, the names of the module that it may mean, the first one that exists.
    discovers
        Whether it discovers members among the files of its folder.
    """

    identity: str
    imports: list[list[str]]
    discovers: bool


@functools.cache
def source_code(file: Path) -> SourceCode:
    """Return what decides in a file, and what it imports."""
    content = file.read_bytes()
    key = checksum(content, Path(__file__))
    with contextlib.suppress(KeyError, TypeError):  # not known, or remembered in a file that was damaged
        return SourceCode(**_known[key])
    found = _parsed(content.decode("utf-8"))
    _known[key] = asdict(found)
    return found


@contextlib.contextmanager
def known() -> Iterator[None]:
    """Begin with what earlier processes found, and leave what this one finds, where there is a place for it."""
    folder = kernel_cache.kept("sources")
    if folder is None:
        yield
        return
    file = folder / "sources.json"
    with contextlib.suppress(OSError, ValueError, TypeError, RecursionError):
        _known.update(json.loads(file.read_text(encoding="utf-8")))
    before = len(_known)
    yield
    if len(_known) > before:
        with contextlib.suppress(OSError), written_whole(file) as partial:
            partial.write_text(json.dumps(_known), encoding="utf-8")


def _parsed(source: str) -> SourceCode:
    """Return what decides in source code, and what it imports."""
    imports, discovers = list[list[str]](), False
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            imports += [[alias.name] for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            imports += [[f"{node.module}.{alias.name}", node.module] for alias in node.names]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "discover":
            discovers = True
    return SourceCode(checksum(canonical(source).encode()), imports, discovers)


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
