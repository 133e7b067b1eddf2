"""Documents: what they show is run, as it stands or as `HOW` lists; nothing is shown that is not in the list.

Each page has a folder of its own with the files that it speaks of. Commands of `palpate` run within this process, the
workflow as a dry run.
"""

import glob
import itertools
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import yaml
from anton_paar_text import single
from documents import DOCS
from elastic_study import CONE, MATERIAL, PROTOCOL, SETTINGS

import palpate
from palpate.cli.main import main

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
DRY = "dry run"
INSTALLS = "installs from a package index"
LONG = "takes longer than all tests of the documents may"
TESTS = "is this suite"
HOW = {
    "README.md": {
        "python3 -m venv .venv": INSTALLS,
        "pip install -q -c constraints.txt -e .": INSTALLS,
        "pip install -q -c constraints.txt -e '.[test]'": INSTALLS,
        "pip install -q -c constraints.txt -e '.[docs]'": INSTALLS,
        "snakemake --cores 2": DRY,
        "pytest -n auto": TESTS,
        "mkdocs build": INSTALLS,
        "palpate draft FILES_OR_FOLDER -o my_study": "palpate draft anonNI.TXT -o my_study",
        "palpate check my_study/study.yaml": "",
        "palpate run my_study/study.yaml": DRY,
    },
    "blind_trial.md": {"snakemake --cores 2 challenge --configfile config/challenge.yaml": DRY},
    "cluster.md": {
        "pip install snakemake-executor-plugin-slurm": INSTALLS,
        "snakemake --profile profiles/slurm --configfile my_study/study.yaml": "needs the plugin and a cluster",
    },
    "epoxy_study.md": {"snakemake --cores 2": "is that of the README"},
    "gallery.md": {
        "palpate figures epon862 --format pdf,svg --width 90mm --no-title": "needs the results of the default study",
    },
    "index.md": {
        "python3 -m venv .venv": INSTALLS,
        "pip install -q -c constraints.txt -e .": INSTALLS,
    },
    "new_law.md": {"pytest tests/materials/test_laws_of_flow.py tests/solver/test_laws_in_bodies.py": TESTS},
    "new_mechanism.md": {"pytest tests/mechanisms/test_mechanisms.py": TESTS},
    "new_observable.md": {"pytest tests/observables/test_observables.py": TESTS},
    "own_recordings.md": {
        "palpate read 'Lab/2024-03-05/Test 2 mN 20 s site 1.txt' --columns "
        "'time=Time [s],load=Force [uN],depth=Depth [um]' --survey -o look": "",
        "palpate draft Lab/2024-03-05 --columns 'time=Time [s],load=Force [uN],depth=Depth [um]' -o my_polymer": "",
        "palpate check my_polymer/study.yaml": "",
        "palpate run my_polymer/study.yaml --cores 2": DRY,
    },
    "real_recordings.md": {
        "snakemake --cores 2 real --config data=FOLDER": "needs recordings that are not in the repository",
    },
    "shared_instruments.md": {
        "palpate run config/instrument/virtual_bulk.yaml": DRY,
        "palpate run config/instrument/virtual_film.yaml": "needs the results of the other study",
    },
    "simulations.md": {
        "palpate simulate SPEC.yaml -o curve.csv": "",
        "palpate fields SPEC.yaml --time 30,60 -o fields": "",
        "palpate export SPEC.yaml --format abaqus -o FOLDER": "palpate export PLAIN.yaml --format abaqus -o FOLDER",
        "palpate export SPEC.yaml --format calculix -o DECK.inp": (
            "palpate export HOOKE.yaml --format calculix -o DECK.inp"
        ),
        "palpate verify -o verification --quick": LONG,
    },
    "snakemake_module.md": {
        "snakemake --cores 2 indentation_all": DRY,
        "snakemake --cores 2 --configfile my_study/study.yaml --config seed=7": DRY,
    },
    "thesis.md": {"snakemake --cores 2 thesis": DRY},
    "tracking.md": {
        "palpate ui": "is a server that does not end",
        "palpate runs": "needs runs of the default study",
        "palpate track": "",
        "palpate track --send": "",
        "pip install psycopg2-binary": INSTALLS,
        "mlflow db upgrade postgresql://USER@HOST/mlflow": "is tried by `.ci/postgresql`",
        "mlflow server --backend-store-uri postgresql://USER@HOST/mlflow --artifacts-destination /srv/mlflow "
        "--host 0.0.0.0": "likewise",
    },
    "tutorial.md": {
        "palpate read anonNI.TXT --survey -o look": "",
        "palpate draft anonNI.TXT -o my_study": "",
        "palpate check my_study/study.yaml": "",
        "palpate run my_study/study.yaml": "is that of the README",
    },
    "vendor_files.md": {"palpate read FILE -o FOLDER": "palpate read anonNI.TXT -o FOLDER"},
}
PROGRAMS = ("palpate", "snakemake", "pip", "python3", "pytest", "mkdocs", "mlflow")
STUDY = SETTINGS | {"study": "my_study"}


def shown(page):
    """Return the commands of a page, each once, without the path of the environment."""
    found = {}
    for line in re.findall(r"^ {4}(.*)$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S), re.M):
        for part in line.split("&&"):
            words = shlex.split(part) if part.count('"') % 2 == 0 == part.count("'") % 2 else [""]
            program = words[0].removeprefix(".venv/bin/") if words else ""
            if program in PROGRAMS:
                found[shlex.join([program, *words[1:]]).replace("'Lab/*/*.txt'", "Lab/*/*.txt")] = None
    return list(found)


def test_every_command_of_the_documents_is_in_the_list():
    listed = {
        page: sorted(shlex.join(shlex.split(command)).replace("'Lab/*/*.txt'", "Lab/*/*.txt") for command in commands)
        for page, commands in HOW.items()
    }
    assert {page.name: sorted(shown(page)) for page in PAGES if shown(page)} == listed


def curve(load):
    """Return an elastic test to a largest load [mN] with a hold."""
    return palpate.simulate(material=MATERIAL, indenter=CONE, protocol=PROTOCOL | {"max_load": load, "points": 300})


@pytest.fixture(scope="module")
def curves():
    return {load: curve(load) for load in (1.0, 2.0, 4.0)}


@pytest.fixture
def folder(tmp_path, monkeypatch, curves):
    """Return a folder with the files that the documents speak of: a vendor's file, a laboratory's own, a study."""
    monkeypatch.chdir(tmp_path)
    columns = np.column_stack([curves[2.0].time, curves[2.0].load, curves[2.0].time, curves[2.0].depth])
    Path("anonNI.TXT").write_text(single(columns))
    Path("Lab/2024-03-05").mkdir(parents=True)
    for load, test in curves.items():
        rows = np.column_stack([test.time, 1e3 * test.load, 1e-3 * test.depth])
        text = "\n".join(";".join(f"{x:.6f}".replace(".", ",") for x in row) for row in rows)
        file = Path(f"Lab/2024-03-05/Test {load:g} mN 20 s site 1.txt")
        file.write_text(f"Time [s];Force [uN];Depth [um]\n{text}\n")
    Path("config").symlink_to(ROOT / "config")
    Path("my_study").mkdir()
    Path("my_study/study.yaml").write_text(yaml.safe_dump(STUDY))
    return tmp_path


def workflow(words, folder):
    """Run Snakemake in a folder, with the workflow of the repository unless the folder has one."""
    own = (folder / "Snakefile").is_file()
    words = [str(folder / word) if word.startswith("my_") else word for word in words]
    place = [] if own else ["--directory", str(folder)]
    command = [sys.executable, "-m", "snakemake", *words, *place, "--quiet"]
    return subprocess.run(command, cwd=folder if own else ROOT, capture_output=True, text=True)


def run(command, folder, dry=False):
    program, *words = shlex.split(command)
    words = [name for word in words for name in (sorted(glob.glob(word)) or [word])]
    if program == "palpate":
        assert main([*words, *(["--dry-run"] if dry else [])]) == 0, command
    else:
        found = workflow([*words, *(["--dry-run"] if dry else [])], folder)
        assert found.returncode == 0, f"{command}: {found.stderr[-2000:]}"


@pytest.mark.parametrize("page", [pytest.param(page, id=page.name) for page in PAGES if page.name in HOW])
@pytest.mark.slow
def test_commands_run(page, folder):
    text = page.read_text()
    if page.name in ("README.md", "tutorial.md"):
        Path("my_study/study.yaml").unlink()
    if page.name == "simulations.md":
        (block,) = re.findall(r"^```yaml\n(.*?)^```", text, re.M | re.S)
        Path("SPEC.yaml").write_text(block)
        plain = {key: value for key, value in yaml.safe_load(block).items() if key != "mechanisms"}
        Path("PLAIN.yaml").write_text(yaml.safe_dump(plain))
        Path("HOOKE.yaml").write_text(yaml.safe_dump(plain | {"material": MATERIAL}))
    if page.name == "snakemake_module.md":
        (block,) = re.findall(r"^```text\n# Snakefile\n(.*?)^```", text, re.M | re.S)
        Path("Snakefile").write_text(block.replace("PATH/TO/palpate", str(ROOT)))
        Path("study.yaml").write_text(yaml.safe_dump(STUDY))
    for command, how in HOW[page.name].items():
        if how in ("", DRY) or how.startswith("palpate "):
            run(how if how.startswith("palpate ") else command, folder, how == DRY)
        if command.startswith("snakemake --cores 2 indentation"):
            Path("Snakefile").unlink()


def test_the_specification_of_the_documents_is_exported_without_its_mechanism_only(folder):
    (block,) = re.findall(r"^```yaml\n(.*?)^```", (DOCS / "simulations.md").read_text(), re.M | re.S)
    Path("SPEC.yaml").write_text(block)
    assert main(["export", "SPEC.yaml", "--format", "abaqus", "-o", "FOLDER"]) == 2


@pytest.mark.slow
def test_the_notebook_runs_on_a_smaller_study(folder, monkeypatch, capsys):
    """The block of the page; in place of its draft, which takes eight minutes, an elastic study of four materials."""
    from palpate import Study

    small = Study.from_mapping(STUDY | {"recordings": {"lab": "recordings"}})

    def draft(test):
        Path("recordings").mkdir()
        replace(test.recording, notes=()).write(Path("recordings/A_1.csv"))
        return small

    monkeypatch.setattr(Study, "draft", draft)
    matplotlib.use("Agg")
    (block,) = re.findall(r"^```python\n(.*?)^```", (DOCS / "notebook.md").read_text(), re.M | re.S)
    names = {}
    exec(block, names)
    assert names["found"].verdict in capsys.readouterr().out


def test_python_is_shown_in_the_notebook_alone():
    found = list(itertools.chain(*(re.findall(r"^```python", page.read_text(), re.M) for page in PAGES)))
    assert len(found) == 1
