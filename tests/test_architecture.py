"""The plan of the house: imports point one way, and the workflow stays outside."""

import ast
import re
from pathlib import Path

import pytest

from palpate.fingerprint import PHYSICS

SOURCE = Path(__file__).parent.parent / "src/palpate"
ORDER = [
    {"errors", "discovery", "fingerprint"},
    {"kernel_cache"},
    {"__init__"},
    {"parameters", "area_function", "yaml_file", "schema", "output", "job"},
    {"protocol", "indenters", "contact_point"},
    {"recording", "quantity"},
    {"segments", "alignment", "load_history", "correlated"},
    {"drift_rate", "sharp_origin"},
    {"survey"},
    {"materials"},
    {"specimen"},
    {"fem", "specification"},
    {"fem3d"},
    {"mechanisms", "analytic", "export", "vtu"},
    {"displaced"},
    {"variation"},
    {"model"},
    {"readers"},
    {"design", "levels"},
    {"config"},
    {"snapshots", "laboratory", "inference"},
    {"surrogate"},
    {"classical"},
    {"calibration"},
    {"observations"},
    {"figures", "report", "grouping"},
    {"diagnosis"},
    {"steps", "reading", "verification", "challenge", "draft"},
    {"thesis", "real", "checking", "doubts"},
    {"tracking"},
    {"commands"},
    {"cli"},
]
LEVEL = {name: k for k, names in enumerate(ORDER) for name in names}
FILES = sorted(SOURCE.rglob("*.py"))


def imports(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{a.name}" if node.module == "palpate" else node.module for a in node.names)


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(SOURCE)))
def test_imports_point_one_way(file):
    own = file.relative_to(SOURCE).parts[0].removesuffix(".py")
    for name in imports(file):
        assert not name.startswith("snakemake"), "nothing in src knows Snakemake"
        parts = name.split(".")
        if parts[0] == "palpate" and len(parts) > 1 and parts[1] != own and parts[1] in LEVEL:
            assert LEVEL[parts[1]] < LEVEL[own] or (parts[1], own) == ("commands", "cli"), f"{own} imports {parts[1]}"


def test_only_scripts_know_the_tracking_module():
    users = [f for f in FILES if f.name != "tracking.py" and any("tracking" in name for name in imports(f))]
    assert users == []


def test_files_hold_one_idea():
    long = {str(f.relative_to(SOURCE)): n for f in FILES if (n := len(f.read_text().splitlines())) > 400}
    assert long == {}


def test_scripts_are_thin():
    for script in (SOURCE.parent.parent / "scripts").glob("*.py"):
        assert len(script.read_text().splitlines()) <= 35, script.name


def test_addresses_of_snapshots_know_all_code_that_decides_a_curve():
    """What reads and checks parameters, or writes load histories, shows in what an address holds besides.

    Where compiled kernels are kept decides nothing.
    """
    seen, pending = set(), ["model"]
    while pending:
        name = pending.pop()
        if name not in seen:
            seen.add(name)
            folder = SOURCE / name
            files = folder.rglob("*.py") if folder.is_dir() else [SOURCE / f"{name}.py"]
            pending += [found.split(".")[1] for file in files for found in imports(file) if "palpate." in found]
    known = {part.removesuffix(".py") for part in PHYSICS}
    assert seen - known == {"errors", "discovery", "kernel_cache", "parameters", "load_history"}


def rules(file):
    """Return the text of each rule of a file of the workflow."""
    text = (SOURCE.parent.parent / "workflow/rules" / file).read_text()
    return re.split(r"^ *rule\b", text, flags=re.MULTILINE)[1:]


def test_studies_of_the_thesis_know_the_laboratory_that_they_use():
    users = [f for f in (SOURCE / "thesis").glob("*.py") if "palpate.laboratory" in set(imports(f))]
    assert users
    (study,) = (rule for rule in rules("thesis.smk") if rule.strip().startswith("thesis_study:"))
    assert "LABORATORY_CODE" in study
