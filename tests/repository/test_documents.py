"""Documents: links lead somewhere, commands parse, Python compiles, studies load, and what is generated is complete."""

import ast
import importlib
import re
import shlex
from pathlib import Path
from typing import Annotated

import pytest
import yaml
from documents import DOCS, HOOKS
from pydantic import TypeAdapter

from indentation_files.readers import READERS
from palpate.cli.main import command_line
from palpate.configuration.study_file import study_from
from palpate.configuration.study_sections import StudyFile
from palpate.materials import LAWS
from palpate.mechanisms import MECHANISMS
from palpate.solver.simulation import KEYS, specification_from

ROOT = Path(__file__).parents[2]
PAGES = sorted(DOCS.glob("*.md"))
SITE = [ROOT / "README.md", *PAGES]
DOCUMENTS = [
    *SITE,
    ROOT / "CONTRIBUTING.md",
    ROOT / "CHANGELOG.md",
    *ROOT.glob("results/*.md"),
    *ROOT.glob("studies/*/*.md"),
]
RULES = [ROOT / "Snakefile", *ROOT.glob("workflow/rules/*.smk"), *ROOT.glob("studies/*/rules.smk")]
TARGETS = {name for file in RULES for name in re.findall(r"^ *rule (\w+):", file.read_text(), re.MULTILINE)}
PART = "# part of"  # how a block of YAML that is no whole study begins


GENERATED = {f"api/{name}.md" for name, _ in HOOKS.packages()} | {"api/index.md"}


def named(files):
    return [pytest.param(file, id=str(file.relative_to(ROOT))) for file in files]


def blocks(file, language):
    """Return the fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", file.read_text(), re.MULTILINE | re.DOTALL)


def prose(file):
    """Return a document without its blocks of code."""
    text = re.sub(r"^```.*?^```", "", file.read_text(), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^(    .*)$", "", text, flags=re.MULTILINE)


def anchors(file):
    """Return the places of a page that a link may name."""
    found = set()
    for line in re.findall(r"^#+ (.+)$", HOOKS.expanded(file.read_text()), re.MULTILINE):
        own = re.search(r"\{ #(\S+) \}", line)
        found.add(own[1] if own else re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", line).strip().lower()))
    return found


@pytest.mark.parametrize("file", named(DOCUMENTS))
def test_links_and_images_lead_somewhere(file):
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(file)):
        if re.match(r"https?:", target):
            continue
        path, _, anchor = target.partition("#")
        aim = (file.parent / path).resolve() if path else file
        generated = aim.is_relative_to(DOCS) and str(aim.relative_to(DOCS)) in GENERATED
        assert generated or aim.exists(), target
        if anchor:
            assert anchor in anchors(aim), target


def test_every_page_has_its_place_in_the_navigation():
    def pages(entry):
        if isinstance(entry, str):
            return [entry]
        return [page for part in (entry.values() if isinstance(entry, dict) else entry) for page in pages(part)]

    listed = pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"])
    assert len(listed) == len(set(listed))
    assert set(listed) - GENERATED == {page.name for page in PAGES}


def test_the_readme_is_short():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 100


def commands(file, program):
    """Yield the words of each command of a program that is shown in a block of its own."""
    for line in re.findall(r"^ {4}(.*)$", file.read_text(), re.MULTILINE):
        for part in line.split("&&"):
            if re.match(rf"\s*(\.venv/bin/)?{program}\s", part):
                yield [word for word in shlex.split(part)[1:] if word != "..."]


def mentions(file, program):
    """Yield the words of each command of a program that is named within a sentence."""
    for code in re.findall(rf"`{program} ([^`]+)`", prose(file)):
        yield [word for word in shlex.split(code) if word != "..."]


@pytest.mark.parametrize("file", named(DOCUMENTS))
def test_commands_of_palpate_parse(file):
    parser = command_line()
    for words in commands(file, "palpate"):
        parser.parse_args(words)
    known = next(action for action in parser._actions if action.choices).choices
    for name, *words in mentions(file, "palpate"):
        assert name in known
        assert {word for word in words if word.startswith("-")} <= set(known[name]._option_string_actions), words


@pytest.fixture(scope="module")
def workflow_parser():
    return importlib.import_module("snakemake.cli").get_argument_parser()


@pytest.mark.parametrize("file", named(DOCUMENTS))
def test_commands_of_snakemake_parse_and_their_targets_exist(file, workflow_parser):
    for words in [*commands(file, "snakemake"), *mentions(file, "snakemake")]:
        given = workflow_parser.parse_args(words)
        for target in given.targets or ():
            assert target.removeprefix("indentation_") in TARGETS or target.startswith("results/"), target
        for study in map(str, given.configfile or ()):
            assert not study.startswith("config/") or (ROOT / study).is_file(), study


@pytest.mark.parametrize("file", named(SITE))
def test_python_compiles_and_imports_what_exists(file):
    for block in blocks(file, "python"):
        for node in ast.walk(ast.parse(block)):
            if isinstance(node, ast.Import):
                for name in node.names:
                    importlib.import_module(name.name)
            elif isinstance(node, ast.ImportFrom):
                module = importlib.import_module(node.module)
                for name in node.names:
                    assert hasattr(module, name.name), f"{node.module}.{name.name}"


def write_recordings(values):
    """Write what a study of the documents follows."""
    for folder in map(Path, values["recordings"].values()):
        folder.mkdir(parents=True)
        for condition in values["conditions"]:
            curve = "time_s,load_mN,depth_nm\n0,0,0\n30,1,500\n60,1,520\n90,0,400\n"
            (folder / f"{condition['name']}_1.csv").write_text(curve)


@pytest.mark.parametrize("file", named(SITE))
def test_studies_and_specifications_load(file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in blocks(file, "yaml"):
        values = yaml.safe_load(block)
        if block.startswith(PART):
            for key, value in values.items():
                assert key in StudyFile.model_fields or key in KEYS, key
                if key in StudyFile.model_fields:
                    field = StudyFile.model_fields[key]
                    TypeAdapter(Annotated[field.annotation, field]).validate_python(value)
        elif "protocol" in values:
            specification_from(values)
        else:
            write_recordings(values)
            study_from(values, file)


def test_what_is_generated_lists_every_law_mechanism_command_and_subpackage():
    laws, mechanisms, shown = HOOKS.laws(), HOOKS.mechanisms(), HOOKS.commands()
    listed = HOOKS.mechanism_table()
    for law in LAWS.values():
        assert f"## `{law.key}`" in laws
        assert all(f"`{parameter.name}`" in laws for parameter in law.parameters)
    for mechanism in MECHANISMS.values():
        assert f"{{ #{mechanism.key} }}" in mechanisms
        assert all(f"`{parameter.name}`" in mechanisms for parameter in mechanism.parameters)
        assert mechanism.source in mechanisms
        assert f"[`{mechanism.key}`]" in listed
    chosen = next(action for action in command_line()._actions if action.choices)
    for name, parser in chosen.choices.items():
        assert f"## `palpate {name}`" in shown
        for action in parser._actions[1:]:
            assert HOOKS._spelt(action) in shown
            assert action.help, f"{name} {action.dest} has no meaning"
    assert all(f"| `{room.removeprefix('palpate/')}` |" in HOOKS.subpackages() for room in HOOKS._order())


def test_what_a_change_touches_is_counted_in_the_code():
    """A reader, a subcommand, a case of the verification and most laws and mechanisms are named in no other file."""
    rows = {row.split(" | ")[0].strip("| "): row.split(" | ")[3] for row in HOOKS.extensions().splitlines()[2:]}
    assert rows.keys() == HOOKS.KINDS.keys()
    counts = {kind: [int(word) for word in row.split(" of ")] for kind, row in rows.items()}
    assert counts["law"][1] == len(LAWS) and counts["mechanism"][1] == len(MECHANISMS)
    assert counts["reader"][1] == len(READERS)
    for kind in ("reader", "subcommand", "case of the verification"):
        assert counts[kind][0] == counts[kind][1] > 0


@pytest.mark.parametrize("file", named(PAGES))
def test_what_a_page_asks_to_be_generated_is(file):
    assert "<!-- generated" not in HOOKS.expanded(file.read_text())


def test_every_package_has_a_page_of_the_api_with_its_modules():
    for name, folder in HOOKS.packages():
        page = HOOKS.api_page(name, folder)
        assert all(f"::: {name}.{file.stem}" in page for file in folder.glob("*.py") if file.stem != "__init__")


def test_the_keys_of_a_study_name_every_mechanism():
    page = (DOCS / "study.md").read_text()
    assert all(f"`{key}`" in page for key in MECHANISMS)
