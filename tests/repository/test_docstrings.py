"""Every public function with four or more arguments says what each of them is."""

import ast
import re
from pathlib import Path

import pytest
from test_architecture import arguments

SOURCE = Path(__file__).parents[2] / "src"
MODULES = {
    ".".join(file.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): ast.parse(file.read_text())
    for file in sorted(SOURCE.rglob("*.py"))
}
NAMED = {
    f"{module}.{node.name}": ast.get_docstring(node) or ""
    for module, tree in MODULES.items()
    for node in ast.walk(tree)
    if isinstance(node, ast.FunctionDef | ast.ClassDef)
} | {module: ast.get_docstring(tree) or "" for module, tree in MODULES.items()}
FEW = 3


def public_functions(module, node, inside=""):
    """Yield the public functions of a module, and the public methods of its public classes, with their names."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ClassDef) and not child.name.startswith("_"):
            yield from public_functions(module, child, f"{child.name}.")
        elif isinstance(child, ast.FunctionDef) and not child.name.startswith("_"):
            yield f"{module}.{inside}{child.name}", child


def docstrings(module, function):
    """Return the docstrings of a function, of its module and of what it refers to, and of what that refers to."""
    own = ast.get_docstring(function) or ""
    text, looked = f"{own}\n{ast.get_docstring(MODULES[module]) or ''}", set()
    for _ in range(2):
        for name in set(re.findall(r"`([\w.]+)`", text)) - looked:
            looked.add(name)
            text += "\n" + (NAMED.get(name) or NAMED.get(f"{module}.{name}") or "")
    return text


FUNCTIONS = [
    pytest.param(module, function, id=name.removeprefix("palpate."))
    for module, tree in MODULES.items()
    for name, function in public_functions(module, tree)
    if len(arguments(function)) > FEW
]


@pytest.mark.parametrize(("module", "function"), FUNCTIONS)
def test_every_argument_is_explained(module, function):
    text = docstrings(module, function)
    assert [name for name in arguments(function) if not re.search(rf"(?<!\w){name}(?!\w)", text)] == []
