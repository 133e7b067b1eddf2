"""The plan of the house: imports point one way, every name stands once, and the workflow stays outside."""

import ast
import re
from collections import Counter
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
SOURCE = REPOSITORY / "src"
ROOMS = """
    errors base materials study observables mechanisms analytic design configuration data solver laboratory
    models surrogate classical inference diagnosis output draft choice workflow_support notebook cli
""".split()  # noqa: SIM905 - each may import those before it
LEVEL = {name: k for k, name in enumerate(ROOMS)}
FILES = sorted(SOURCE.rglob("*.py"))
OF_PALPATE = [file for file in FILES if file.relative_to(SOURCE).parts[0] == "palpate"]
OF_FILES = [file for file in FILES if file.relative_to(SOURCE).parts[0] == "indentation_files"]
HEAVY = ("palpate", "numba", "snakemake", "mlflow", "sklearn", "matplotlib")
MODULES = {".".join(f.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): f for f in FILES}
STUDIES = sorted((REPOSITORY / "studies").rglob("*.py"))


def imports(file):
    for node in ast.walk(parsed(file)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            package = node.module in ("palpate", "indentation_files")
            yield from (name if name in MODULES or package else node.module for name in whole)


@pytest.mark.parametrize("file", OF_PALPATE, ids=lambda f: str(f.relative_to(SOURCE)))
def test_imports_point_one_way(file):
    own = file.relative_to(SOURCE).parts[1].removesuffix(".py")
    for name in imports(file):
        assert not name.startswith(("snakemake", "studies")), f"nothing in src knows {name.split('.')[0]}"
        parts = name.split(".")
        if parts[0] == "palpate" and len(parts) > 1 and parts[1] in LEVEL and own in LEVEL and parts[1] != own:
            assert LEVEL[parts[1]] < LEVEL[own], f"{own} imports {parts[1]}"


@pytest.mark.parametrize("file", OF_FILES, ids=lambda f: str(f.relative_to(SOURCE)))
def test_files_of_instruments_are_read_without_palpate(file):
    assert [name for name in imports(file) if name.split(".")[0] in HEAVY] == []


def test_no_circle_of_imports():
    """Neither between packages nor inside one, not even for type checking."""
    used = {name: MODULES.keys() & (set(imports(file)) - {name}) for name, file in MODULES.items()}
    try:
        TopologicalSorter(used).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


def test_every_room_has_its_place():
    rooms = {file.relative_to(SOURCE).parts[1].removesuffix(".py") for file in OF_PALPATE}
    assert rooms - {"__init__"} == set(ROOMS)


def test_no_two_modules_share_a_name():
    """In one package."""
    names = Counter((file.relative_to(SOURCE).parts[0], file.name) for file in FILES if file.name != "__init__.py")
    assert [name for name, count in names.items() if count > 1] == []


def test_only_scripts_and_the_command_line_know_the_tracking_module():
    users = {f.name for f in FILES if any("tracking" in name for name in imports(f))}
    assert users == {"runs.py", "track.py", "ui.py"}


def functions_of(tree):
    """Return the functions of a file, each with its decorators as written."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return {function: " ".join(map(ast.unparse, function.decorator_list)) for function in functions}


def test_only_kernels_call_inner_kernels():
    """A call from Python ends the process."""
    files = (*FILES, *STUDIES, *(REPOSITORY / "tests").rglob("*.py"))
    trees = {file: parsed(file) for file in files}
    functions = {file: functions_of(tree) for file, tree in trees.items()}
    inner = {(file.stem, f.name) for file in FILES for f, how in functions[file].items() if "inner_kernel" in how}
    assert len(inner) > 50
    for file, tree in trees.items():
        named = {name: (stem, name) for stem, name in inner if stem == file.stem}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                named |= {alias.name: (node.module.split(".")[-1], alias.name) for alias in node.names}
        for function, how in functions[file].items():
            if not re.search("njit|inner_kernel|overload", how):
                calls = [ast.unparse(node.func) for node in ast.walk(function) if isinstance(node, ast.Call)]
                called = {named.get(call, tuple(call.split("."))) for call in calls}
                assert (function.name, called & inner) == (function.name, set()), file


def test_files_hold_one_idea():
    long = {str(f.relative_to(SOURCE)): n for f in FILES if (n := len(f.read_text().splitlines())) > 400}
    assert long == {}


MODULE, CODE, ARGUMENTS = 300, 60, 8  # lines of a module, lines of a function's code, arguments
LARGE_MODULES = {
    "palpate/inference/fitting.py": "one algorithm: the way of a fit from level to level",
    "palpate/inference/trust_region.py": "one algorithm",
    "palpate/solver/axisymmetric/hencky.py": "one strain measure: its derivatives, forces and stiffness",
    "palpate/solver/axisymmetric/lanes.py": "the instructions of one vector type",
    "palpate/solver/axisymmetric/newton.py": "one algorithm",
    "palpate/solver/simulation.py": "the one entry to the solvers",
}
LARGE_FUNCTIONS = {
    "palpate/solver/axisymmetric/element.py internal_forces": "one pass over an element's Gauss points",
    "palpate/solver/axisymmetric/hencky.py stiffness": "one pass over an element's Gauss points",
    "palpate/solver/axisymmetric/newton.py advance": "one loop, whose lanes share twenty arrays",
    "palpate/solver/pyramid/element_3d.py assemble": "one pass over the elements",
    "palpate/solver/pyramid/hencky_3d.py element": "one pass over an element's Gauss points",
    "palpate/solver/pyramid/linear_3d.py element": "one pass over an element's Gauss points",
    "palpate/solver/pyramid/newton_3d.py advance": "one loop of Newton's method",
}


def functions():
    """Yield each function with the name of its file."""
    for file in FILES:
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.FunctionDef):
                yield f"{file.relative_to(SOURCE)} {node.name}", node


def lines_of_code(name, function):
    """Return the number of lines of a function below its signature and docstring, comments aside."""
    first = function.body[1 if ast.get_docstring(function) and len(function.body) > 1 else 0]
    lines = lines_of(name.split()[0])[first.lineno - 1 : function.end_lineno]
    return sum(not line.lstrip().startswith("#") for line in lines)


@cache
def lines_of(name):
    return (SOURCE / name).read_text().splitlines()


@cache
def parsed(file):
    return ast.parse(file.read_text())


def arguments(function):
    given = function.args
    names = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return names[names[:1] in (["self"], ["cls"]) :]


def test_what_is_large_says_why():
    modules = {str(f.relative_to(SOURCE)) for f in FILES if len(f.read_text().splitlines()) > MODULE}
    assert modules <= set(LARGE_MODULES)
    assert {name for name, f in functions() if lines_of_code(name, f) > CODE} <= set(LARGE_FUNCTIONS)
    assert [name for name, f in functions() if len(arguments(f)) > ARGUMENTS] == []


def test_tests_mirror_the_packages():
    """Each file of tests lies in a folder of its package; what two folders share is a helper."""
    folders = {"helpers", "repository", "studies", "workflow", *ROOMS, "indentation_files"}
    for file in (REPOSITORY / "tests").rglob("*.py"):
        place = file.relative_to(REPOSITORY / "tests").parts[0]
        assert place in folders or place == "conftest.py", file
        shared = [name for name in imports(file) if name.startswith("test_")]
        assert [name for name in shared if not file.with_name(f"{name.split('.')[0]}.py").is_file()] == [], file


FOUND = ("cli", "materials", "mechanisms", "readers", "figures", "export")  # folders whose modules are discovered
SMALL = 60  # lines
SMALL_MODULES = {
    "indentation_files.__main__": "a command",
    "indentation_files.imprint_profile": "one kind of evidence a file",
    "indentation_files.pop_in": "what a reader of files may use without palpate",
    "palpate.analytic.berkovich": "one solution a file, used by tests",
    "palpate.analytic.hertz": "one solution a file",
    "palpate.analytic.sneddon": "one solution a file",
    "palpate.base.checked_kernels": "the form of compiled kernels, whose content counts for their address",
    "palpate.configuration.recording_sets": "study_file is as long as a module may be",
    "palpate.inference.imprint_prediction": "one kind of evidence a file",
    "palpate.output.report.further_evidence_sections": "sections is as long as a module may be",
    "palpate.output.vtu": "one file format",
    "palpate.solver.axisymmetric.normal_lanes": "contact is as long as a module may be",
    "palpate.solver.axisymmetric.trend": "march_cases is as long as a module may be",
    "palpate.solver.pyramid.fields_3d": "simulation is longer than a module may be",
    "palpate.workflow_support.study_report": "what one script does",
}


def test_small_modules_have_more_than_one_importer_or_say_why():
    outside = [*REPOSITORY.glob("scripts/*.py"), *STUDIES, *REPOSITORY.glob("workflow/rules/*.smk")]
    text = "\n".join(file.read_text() for file in outside)
    users = Counter(name for file in FILES for name in MODULES.keys() & set(imports(file)))
    small = {
        name
        for name, file in MODULES.items()
        if len(file.read_text().splitlines()) < SMALL
        and users[name] + (f"{name} import" in text) <= 1
        and file.name != "__init__.py"
        and file.parent.name not in FOUND
    }
    assert small == set(SMALL_MODULES)


def test_scripts_are_thin():
    for script in [*REPOSITORY.glob("scripts/*.py"), *REPOSITORY.glob("studies/*/scripts/*.py")]:
        assert len(script.read_text().splitlines()) <= 35, script.name


def test_rules_name_the_code_of_the_script_that_they_run():
    """A rule that forgets a change of its own code leaves results that are called up to date."""
    for file in [*REPOSITORY.glob("workflow/rules/*.smk"), *REPOSITORY.glob("studies/*/rules.smk")]:
        for rule in re.split(r"^ *rule\b", file.read_text(), flags=re.MULTILINE)[1:]:
            if script := re.search(r'script:\s*"(.+)"', rule):
                path = (file.parent / script[1]).resolve()
                assert path.is_file(), f"{file.name}: {script[1]}"
                named = re.search(r'code=code\("(.+?)"\)', rule)
                assert not named or REPOSITORY / named[1] == path, f"{file.name}: {script[1]}"


def test_no_class_name_means_two_things():
    names = Counter(node.name for file in FILES for node in ast.walk(parsed(file)) if isinstance(node, ast.ClassDef))
    assert [name for name, count in names.items() if count > 1] == []
