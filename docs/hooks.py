"""What MkDocs asks of this project: pages that the code itself writes, and formulas as MathML.

A comment such as ``<!-- generated: laws -->`` in a page is replaced by what `GENERATED` returns under that name, and
``<!-- generated: source FILE -->`` by a file of the package; what is said of the epoxy study comes from
`epoxy_results`. One page of the Python API is made for each package of ``src``.
"""

from __future__ import annotations

import argparse
import ast
import html
import importlib
import inspect
import json
import math
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

sys.path.insert(0, str(Path(__file__).parent))
import epoxy_results
from markdown_pieces import number, span, table, unit

SOURCE = Path(__file__).parents[1] / "src"
MARK = re.compile(r"<!-- generated: (\w+)(?: ([\w./]+))? -->")
FORMULA = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\[(\[](?P<tex>.*?)\\[)\]]</(?P=tag)>', re.DOTALL
)  # as pymdownx.arithmatex leaves it
RESULTS = {
    "Calibration": "palpate.output.results.calibration",
    "Diagnosis": "palpate.output.results.diagnosis",
}  # what the functions of the front door return, and the module of each
TYPICAL = {
    "depth": 500.0, "load": 1.0, "modulus": 3.0, "duration": 60.0, "loading_time": 30.0, "half_angle": 70.3,
    "pressure": 0.1,
}  # fmt: skip


def documentation(member: Any) -> str:
    """Return the docstring of the module that declares a law or mechanism."""
    return inspect.cleandoc(sys.modules[member.__module__].__doc__ or "")


def parameters(declared: Iterable[Any]) -> str:
    """Return the table of some parameters."""
    rows = (
        (
            f"`{p.name}`", f"${p.symbol}$", p.meaning, unit(p.unit), span(p.lower, p.upper),
            "required" if p.default is None else f"`{number(p.default)}`",
        )
        for p in declared
    )  # fmt: skip
    return table(("parameter", "symbol", "meaning", "unit", "range", "default"), rows)


def laws() -> str:
    """Return one section a law: its equations and its parameters."""
    from palpate.materials import LAWS
    from palpate.materials.law import ELASTIC

    parts = ["## Parameters of every law\n", parameters(ELASTIC)]
    for law in sorted(LAWS.values(), key=lambda law: (law.key != "elastic", law.key)):
        parts += [f"## `{law.key}`\n", _described(law) + "\n"]
        parts += [parameters(law.flow)] if law.flow and law.parts == (law.key,) else []
    return "\n".join(parts)


def _described(law: Any) -> str:
    """Return what the file of a law says of it, or which laws it joins."""
    if law.parts == (law.key,):
        return documentation(law.terms)
    return f"The same as `{'+'.join(law.parts)}`: strains add, and parameters are those of both."


def law_parameters() -> str:
    """Return one table of the parameters of all laws, with the laws that have each."""
    from palpate.materials import LAWS
    from palpate.materials.law import ELASTIC

    owners = {p: ["all"] for p in ELASTIC}
    for law in LAWS.values():
        for p in law.flow if law.parts == (law.key,) else ():
            owners.setdefault(p, []).append(f"`{law.key}`")
    rows = (
        (
            f"`{p.name}`", p.meaning, unit(p.unit), span(p.lower, p.upper),
            "required" if p.default is None else f"`{number(p.default)}`", ", ".join(names),
        )
        for p, names in owners.items()
    )  # fmt: skip
    return table(("parameter", "meaning", "unit", "range", "default", "laws"), rows)


def law_names() -> str:
    """Return one table of all laws, with what the first line of each says."""
    from palpate.materials import LAWS

    rows = ((f"[`{law.key}`](laws.md#{law.key})", _first_line(_described(law))) for law in LAWS.values())
    return table(("law", "what it describes"), rows)


def mechanisms() -> str:
    """Return one section a mechanism: what it is, its parameters, and where a diagnosis searches them."""
    from palpate.mechanisms import MECHANISMS, Scale

    scale = Scale(**TYPICAL)
    every = sorted(MECHANISMS.values(), key=lambda each: each.title)
    rows = ((f"[{m.title}](#{m.key})", f"`{m.key}`", _acts(m), _values(m)) for m in every)
    parts = [table(("mechanism", "key", "acts on", "value"), rows)]
    for mechanism in every:
        parts += [f"## {mechanism.title[0].upper()}{mechanism.title[1:]} {{ #{mechanism.key} }}\n"]
        parts += [documentation(mechanism.plausible) + "\n", parameters(mechanism.parameters)]
        searched = "; ".join(_searched(mechanism, *found) for found in mechanism.plausible(scale).items())
        facts = [("Key", f"`{mechanism.key}`"), ("Searched", searched)]
        facts += [("Acts on", _acts(mechanism)), ("Value", _values(mechanism))]
        facts += [("Considered", "where a study names it")] if not getattr(mechanism, "by_default", True) else []
        special = ", ".join(f"[`{key}`](#{key})" for key in getattr(mechanism, "includes", ()))
        facts += [("Special case", special)] if special else []
        shared = getattr(mechanism, "may_be_shared", False)
        facts += [("Shared", "by [studies on one instrument](shared_instruments.md)")] if shared else []
        facts += [("Measured by", remedy)] if (remedy := getattr(mechanism, "remedy", "")) else []
        facts += [("Source", mechanism.source)]
        parts += ["\n".join(f"- **{name}**: {fact}." for name, fact in facts) + "\n"]
    return "\n".join(parts)


def mechanism_table() -> str:
    """Return one table of all mechanisms: what may be searched of each, within which limits."""
    from palpate.mechanisms import MECHANISMS, Scale

    scale = Scale(**TYPICAL)
    rows = (
        (
            f"[`{m.key}`](mechanisms.md#{m.key})", m.effect,
            "; ".join(_quantity(m, name, searched) for name, searched in m.plausible(scale).items()),
            _values(m), "by default" if m.by_default else "where it is named",
        )
        for m in MECHANISMS.values()
    )  # fmt: skip
    return table(("mechanism", "effect on a recording", "quantities of `ranges`", "value", "considered"), rows)


def _own(mechanism: Any, name: str) -> Any:
    """Return the parameter of a mechanism, or None for another quantity."""
    return next((p for p in mechanism.parameters if p.name == name), None)


def _searched(mechanism: Any, name: str, searched: Any) -> str:
    """Return the plausible range of a quantity with its unit, and what it means where it is no parameter."""
    own = _own(mechanism, name)
    shown = (own or searched).unit
    text = f"`{name}` {span(searched.lower, searched.upper)}{'' if shown == '-' else f' {unit(shown)}'}"
    return text if own else f"{text} ({searched.meaning})"


def _quantity(mechanism: Any, name: str, searched: Any) -> str:
    """Return a quantity with its unit, limits and meaning: a parameter's own, or those of its range."""
    own = _own(mechanism, name)
    shown, meaning = (own.unit, own.meaning) if own else (searched.unit, searched.meaning)
    lower, upper = (own.lower, own.upper) if own else (searched.least, searched.largest)
    limits = span(lower, upper) if math.isfinite(upper) else f"from {number(lower)}"
    return f"`{name}`{'' if shown == '-' else f' [{unit(shown)}]'}, {limits}: {meaning}"


def _acts(mechanism: Any) -> str:
    return "the body" if mechanism.acts_on_body else "the recorded depth"


def _values(mechanism: Any) -> str:
    return "each recording has its own" if mechanism.varies else "one for all recordings"


def keys(name: str) -> str:
    """Return the keys of one table of a study's file, as `palpate.configuration.study_sections` declares them."""
    from palpate.configuration import entries, settings, study_sections

    declared = next(vars(each)[name] for each in (study_sections, entries, settings) if name in vars(each))
    rows = (
        (f"`{key}`", field.description, _accepted(field), _default(field))
        for key, field in declared.model_fields.items()
    )
    return table(("key", "meaning", "accepted", "default"), rows)


def _accepted(field: Any) -> str:
    """Return what a key of a study takes."""
    from pydantic import BaseModel

    from palpate.configuration.checked_file import bare

    kind, extra = bare(field.annotation), field.json_schema_extra
    limits = {
        name: getattr(each, name) for each in field.metadata for name in ("gt", "ge", "lt", "le") if hasattr(each, name)
    }
    if extra["accepted"]:
        text = str(extra["accepted"])
    elif kind is bool:
        text = "true, false"
    elif get_origin(kind) is Literal:
        text = ", ".join(f"`{choice}`" for choice in get_args(kind))
    elif isinstance(kind, type) and issubclass(kind, BaseModel):
        text = "table"
    elif {"ge", "le"} <= set(limits):
        text = span(limits["ge"], limits["le"])
    elif "ge" in limits:
        text = f"{number(limits['ge'])} or more"
    elif "gt" in limits:
        ends = {"lt": ", below {}", "le": ", to {}"}
        text = f"above {number(limits['gt'])}" + "".join(
            ends[name].format(number(limits[name])) for name in ends if name in limits
        )
    else:
        text = "-"
    return text


def _default(field: Any) -> str:
    """Return the default of a key of a study."""
    from pydantic import BaseModel

    if field.is_required():
        return "required"
    if field.default is None:
        return "-"
    if isinstance(field.default, BaseModel):
        return "all defaults"
    given = list(field.default) if isinstance(field.default, tuple) else field.default
    return f"`{given if isinstance(given, str) else json.dumps(given)}`"


def commands() -> str:
    """Return one section a subcommand of ``palpate``: usage and arguments."""
    from palpate.cli.main import command_line

    chosen = next(a for a in command_line()._actions if isinstance(a, argparse._SubParsersAction))
    parts = []
    for name, parser in chosen.choices.items():
        usage = parser.format_usage().removeprefix("usage: ")
        arguments = [a for a in parser._actions if not isinstance(a, argparse._HelpAction)]
        rows = ((f"`{_spelt(a)}`", a.help or "") for a in arguments)
        description = parser.description or ""
        parts += [f"## `palpate {name}`\n", f"{description[:1].upper()}{description[1:]}.\n"]
        parts += [f"```text\n{usage}```\n", table(("argument", "meaning"), rows)]
    return "\n".join(parts)


def _spelt(action: argparse.Action) -> str:
    """Return an argument as it is typed."""
    name = action.metavar or action.dest.upper()
    if not action.option_strings:
        return f"{name} ..." if action.nargs == "+" else str(name)
    value = "" if action.nargs == 0 else f" {{{', '.join(action.choices)}}}" if action.choices else f" {name}"
    return ", ".join(action.option_strings) + value


def subpackages() -> str:
    """Return one table of the subpackages, in the order in which one may import another."""
    rows = []
    for name in _order():
        file = SOURCE / f"{name}.py"
        modules = [file] if file.is_file() else sorted((SOURCE / name).rglob("*.py"))
        lines = sum(len(module.read_text(encoding="utf-8").splitlines()) for module in modules)
        first = _first_line(_docstring(file if file.is_file() else SOURCE / name / "__init__.py"))
        rows.append((f"`{name.removeprefix('palpate/')}`", first, len(modules), lines))
    return table(("subpackage", "what it holds", "files", "lines"), rows)


KINDS = {
    "law": ("src/palpate/materials", "LAW"),
    "mechanism": ("src/palpate/mechanisms", "MECHANISM"),
    "observable": ("src/palpate/observables", "OBSERVABLE"),
    "reader": ("src/indentation_files/readers", "READER"),
    "export format": ("src/palpate/output/export", "FORMAT"),
    "subcommand": ("src/palpate/cli", "NAME"),
    "figure": ("src/palpate/output/figures", "draw or compose"),
    "case of the verification": ("studies/verification/cases", "CASES"),
    "study of the thesis": ("studies/thesis", "STUDY"),
}  # folder of each kind of extension, and what its file defines


def extensions() -> str:
    """Return one row for each kind of extension: its folder, what a file defines, and which other files name one."""
    root = SOURCE.parent
    trees = {
        file: ast.parse(file.read_text(encoding="utf-8"))
        for file in sorted([*SOURCE.rglob("*.py"), *root.glob("scripts/*.py"), *root.glob("studies/**/*.py")])
        if file.name != "__init__.py"
    }
    named = {file: set(_named(tree)) for file, tree in trees.items()}
    rows = []
    for kind, (folder, name) in KINDS.items():
        inside = [file for file in trees if file.parent == root / folder]
        members = {
            f"{folder.removeprefix('src/')}/{file.stem}".replace("/", "."): file
            for file in inside
            if set(name.split(" or ")) & set(_defined(trees[file]))
        }
        keys = {file.stem for file in members.values() if "_" in file.stem and kind in ("law", "mechanism")}
        others = {
            file: {member.rpartition(".")[2] for member in named[file] & set(members)} | named[file] & keys
            for file in trees
            if file not in inside and "studies" not in file.parts
        }
        places = ", ".join(f"`{file.stem}`" for file, found in others.items() if found)
        free = len(members) - len(set().union(*others.values()))
        defined = f"`{name}`".replace(" or ", "` or `")
        rows.append((kind, f"`{folder}`", defined, f"{free} of {len(members)}", places))
    return table(("a new", "is one file in", "that defines", "named nowhere else", "files that name one"), rows)


def _defined(tree: ast.Module) -> Iterator[str]:
    """Yield the names that a module defines at its top level."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for each in targets for target in ast.walk(each) if isinstance(target, ast.Name))


def _named(tree: ast.Module) -> Iterator[str]:
    """Yield the modules that a module imports, and its texts."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def _order() -> list[str]:
    """Return the package of files, and the subpackages as the test of the architecture lists them, below ``src``."""
    text = (SOURCE.parent / "tests/repository/test_architecture.py").read_text(encoding="utf-8")
    rooms = re.search(r'ROOMS = """(.*?)"""', text, re.DOTALL)[1].split()  # type: ignore[index]
    return ["indentation_files", *(f"palpate/{name}" for name in rooms)]


def _docstring(file: Path) -> str:
    return ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""


def _first_line(text: str) -> str:
    """Return the first sentence of a docstring, with double backticks made single."""
    return text.split("\n\n")[0].replace("\n", " ").replace("``", "`")


def packages() -> Iterator[tuple[str, Path]]:
    """Yield name and folder of every package, in the order of the subpackages."""
    order = [name for name in _order() if (SOURCE / name).is_dir()]
    for subpackage in order:
        for init in sorted((SOURCE / subpackage).rglob("__init__.py")):
            if "__pycache__" not in init.parts:
                yield ".".join(init.parent.relative_to(SOURCE).parts), init.parent


def api_page(name: str, folder: Path) -> str:
    """Return the page of one package (Markdown for mkdocstrings): the package, then each module by itself."""
    text = [f"# `{name}`\n", f"{_first_line(_docstring(folder / '__init__.py'))}\n"]
    for module in sorted(folder.glob("*.py")):
        if module.stem != "__init__" and _docstring(module):
            text.append(f"::: {name}.{module.stem}\n    options:\n      heading_level: 2\n")
    return "\n".join(text)


def api_index() -> str:
    """Return the first page of the Python API: the front door, then every package with its first line."""
    import palpate

    rows = []
    for name in palpate.PLACES:
        place = palpate.PLACES[name]
        page = next(package for package, _ in reversed([*packages()]) if place.startswith(f"{package}."))
        rows.append((f"[`{name}`]({page}.md#{place})", _first_line(inspect.getdoc(getattr(palpate, name)) or "")))
    for name, place in RESULTS.items():
        found = getattr(importlib.import_module(place), name)
        rows.append((f"[`{name}`](palpate.output.results.md#{place}.{name})", _first_line(inspect.getdoc(found) or "")))
    door = table(("name", "what it does"), rows)
    every = ((f"[`{name}`]({name}.md)", _first_line(_docstring(f / "__init__.py"))) for name, f in packages())
    return (
        "# Python API\n\nA notebook or a script imports from `palpate` itself; [In a notebook](../notebook.md) shows "
        f"how, and what is printed and drawn.\n\n{door}\n"
        "`calibrate` returns a `Calibration`, `diagnose` a `Diagnosis`; report, MLflow and figures show the same "
        "objects.\n\n"
        "## Packages\n\nFrom the interface down to what all others use; generated from the docstrings.\n\n"
        + table(("package", "what it holds"), reversed([*every]))
    )


def source(file: str) -> str:
    """Return a file of the package as a block of code."""
    return f"```python\n{(SOURCE / file).read_text(encoding='utf-8')}```\n"


GENERATED: dict[str, Callable[..., str]] = {
    "laws": laws,
    "law_names": law_names,
    "law_parameters": law_parameters,
    "mechanisms": mechanisms,
    "mechanism_table": mechanism_table,
    "commands": commands,
    "keys": keys,
    "subpackages": subpackages,
    "extensions": extensions,
    "source": source,
    **epoxy_results.GENERATED,
}


def expanded(markdown: str) -> str:
    """Return a page with everything that the code writes in it."""
    return MARK.sub(lambda found: GENERATED[found[1]](*filter(None, [found[2]])), markdown)


def mathml(page: str) -> str:
    """Return a page (HTML) with its formulas as MathML, which every browser draws without a script."""
    from latex2mathml.converter import convert

    def converted(found: re.Match[str]) -> str:
        block = found["tag"] == "div"
        formula = convert(html.unescape(found["tex"]).strip(), display="block" if block else "inline")
        return f'<div class="formula">{formula}</div>' if block else formula

    return FORMULA.sub(converted, page)


def on_config(config: Any) -> Any:
    """List the pages of the Python API in the navigation."""
    for section in config.nav:
        for title, entries in section.items():
            for entry in entries if title == "Reference" else ():
                if "Python API" in entry:
                    pages = reversed([*packages()])  # the interface first
                    entry["Python API"] = ["api/index.md", *(f"api/{name}.md" for name, _ in pages)]
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the pages of the Python API."""
    from mkdocs.structure.files import File

    files.append(File.generated(config, "api/index.md", content=api_index()))
    for name, folder in packages():
        files.append(File.generated(config, f"api/{name}.md", content=api_page(name, folder)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Expand what the code writes."""
    return expanded(markdown)


def on_page_content(content: str, **_: Any) -> str:
    """Turn formulas into MathML."""
    return mathml(content)
