"""``palpate run``: from any folder, stopped at once, going on where it stopped; installed, without the repository."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import psutil
import pytest
import yaml

from indentation_files.recording import Recording
from palpate.cli.main import main
from palpate.workflow_support import killed_run

ROOT = Path(__file__).parents[2]
PALPATE = Path(sys.executable).parent / "palpate"
STUDY = {
    "study": "elastic",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [2.0, 2.5, 3.0, 3.5]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "points": 12,
    "conditions": [
        {"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30},
        {"name": "B", "max_load": 0.5, "loading_time": 30, "unloading_time": 30},
    ],
    "recordings": {"lab": "results/elastic/recordings/lab"},
    "laboratory": {"lab": {"seed": 3, "replicates": 2, "parameters": {"youngs_modulus": 2.8}}},
    "calibration": {"population": 16, "generations": 4},
    "diagnosis": {"enabled": False},
}
APART = (
    "logs",
    "benchmarks",
    "tracking",
    "mlartifacts",
    "mlflow.db",
    "mlflow.db.lock",
    "snapshots",
    "report.manifest.json",
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    return tmp_path


def run(folder, *arguments):
    return subprocess.run([PALPATE, "run", *arguments], cwd=folder, capture_output=True, text=True)


def begun(command, **options):
    """Start a command that heeds signals, also where `nohup` or a script's background has the tests ignore them."""

    def heed():
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)

    return subprocess.Popen(command, preexec_fn=heed, **options)


def contents(folder):
    """Return the bytes of all results of a folder by name, but for logs and what is sent to MLflow, which hold times.

    The tables of single batches and the manifest, which holds the configuration, follow the size of a batch.
    """
    files = [file for file in (folder / "results").rglob("*") if file.is_file()]
    names = {file.relative_to(folder): file for file in files}
    return {name: file.read_bytes() for name, file in names.items() if not set(APART) & set(name.parts)}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Return the folder of a study that ran on one core."""
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY))
    found = run(folder, "study.yaml", "--cores", "1")
    assert found.returncode == 0, found.stderr[-3000:]
    return folder


@pytest.mark.faults(before="needed a clone of the repository")
@pytest.mark.slow
def test_a_study_runs_away_from_the_repository(undisturbed):
    assert (undisturbed / "results/elastic/report.html").is_file()
    again = run(undisturbed, "study.yaml", "--cores", "1", "--dry-run")
    assert "Nothing to be done" in again.stdout + again.stderr


def test_a_mistake_is_one_line_and_nothing_is_made(folder):
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY | {"pionts": 3}))
    found = run(folder, "study.yaml")
    assert found.returncode == 2
    assert len(found.stderr.splitlines()) == 1 and "did you mean 'points'" in found.stderr
    assert [file.name for file in folder.iterdir()] == ["study.yaml"]


@pytest.mark.faults(before="jobs went on; curves differed by up to 5e-8")
@pytest.mark.slow
def test_interrupted_it_stops_at_once_and_goes_on_to_the_same_bytes_on_other_cores_in_other_batches(
    folder, undisturbed
):
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY | {"cells_per_job": 3}))
    process = begun([PALPATE, "run", "study.yaml", "--cores", "2"], cwd=folder, start_new_session=True)
    while not list(folder.glob("results/store/*/*.npz")):
        assert process.poll() is None
        time.sleep(0.1)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=30) == 130
    assert time.monotonic() - began < 10.0  # a job takes longer
    assert not (folder / "results/elastic/report.html").is_file()
    assert run(folder, "study.yaml", "--cores", "2").returncode == 0
    expected, found = contents(undisturbed), contents(folder)
    assert len(found) > 20
    assert [name for name in expected | found if expected.get(name) != found.get(name)] == []


@pytest.mark.faults(before="jobs went on after the terminal was closed, or the batch system ended the command")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_ends_the_command_ends_its_jobs(number):
    script = "import sys; from palpate.cli.run import _executed; print(flush=True); _executed([*sys.argv[1:]])"
    waits = "import time; print('begun', flush=True); time.sleep(60)"
    process = begun(
        [sys.executable, "-c", script, sys.executable, "-c", waits], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    assert process.stdout.readline() == b"\n"
    assert process.stdout.readline() == b"begun\n"
    (job,) = psutil.Process(process.pid).children()
    process.send_signal(number)
    assert process.wait(timeout=30) != 0
    assert not job.is_running()


@pytest.mark.faults(before="the jobs went on where the signal came before the command knew of them")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_that_comes_while_jobs_are_begun_ends_them(number):
    script = f"""
import os, subprocess, sys
from palpate.cli import run

class Interrupted(subprocess.Popen):
    def _execute_child(self, *arguments):
        super()._execute_child(*arguments)
        print(self.pid, flush=True)
        os.kill(os.getpid(), {int(number)})

run.subprocess.Popen = Interrupted
run._environment = lambda: os.environ
run._executed([sys.executable, "-c", "import time; time.sleep(60)"])
"""
    process = begun([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    job = int(process.stdout.readline())
    assert process.wait(timeout=30) != 0
    assert not psutil.pid_exists(job)


@pytest.mark.parametrize("data", ["2024", "2024/1.5"])
@pytest.mark.slow
def test_data_may_have_the_name_of_a_number(folder, data, capsys, monkeypatch):
    """The folder of the instrument's file, or the file."""
    monkeypatch.chdir(folder)
    time, load = np.linspace(0.0, 60.0, 61), 1.0 - np.abs(np.linspace(-1.0, 1.0, 61))
    Path("2024").mkdir()
    Recording(time, load, 400.0 * np.sqrt(load)).write("2024/1.5")
    source = {"file": "1.5", "recordings": "lab", "conditions": {"A": [1]}}
    given = STUDY | {"source": source, "conditions": STUDY["conditions"][:1], "laboratory": {}}
    Path("study.yaml").write_text(yaml.safe_dump(given))
    monkeypatch.chdir((folder / data).parent)
    name = os.path.relpath(folder / "study.yaml")
    found = run(Path.cwd(), name, "--data", Path(data).name, "--cores", "1", "--dry-run")
    assert found.returncode == 0, found.stdout + found.stderr
    assert main(["check", name, "--data", Path(data).name]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"next: palpate run {name} --data {Path(data).name}"


@pytest.mark.faults(before="44 lines of traceback")
@pytest.mark.slow
def test_a_study_is_planned_without_a_home_folder(folder):
    """And beside a folder `default`, which Snakemake would take for its profile."""
    (folder / "default").mkdir()
    environment = {key: value for key, value in os.environ.items() if key != "XDG_CACHE_HOME"}
    environment["HOME"] = str(folder / "study.yaml")  # in which no folder can be made, not even by root
    command = [PALPATE, "run", "study.yaml", "--cores", "1", "--dry-run"]
    found = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr[-3000:]


@pytest.mark.faults(before="pages of traceback")
def test_a_disk_without_room_is_named_before_anything_runs(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(10**12, 10**12 - 10**6, 10**6))
    assert main(["run", "study.yaml"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        f"palpate: {folder}: less than 20 MB of the disk are free; free space on the disk"
    ]
    assert [file.name for file in folder.iterdir()] == ["study.yaml"]


def states(folder):
    """Return size and time of each file in a folder."""
    found = {file: file.stat() for file in folder.rglob("*") if file.is_file()}
    return {file: (state.st_size, state.st_mtime_ns) for file, state in found.items()}


@pytest.mark.faults(before="an edited number went into the report; a cut table was a traceback")
@pytest.mark.slow
def test_results_that_were_altered_are_refused_and_made_again_where_that_is_asked(undisturbed, tmp_path):
    """Nothing is moved, in an execution, a plan or when a folder is unlocked."""
    shutil.copytree(undisturbed, tmp_path, dirs_exist_ok=True)
    results = tmp_path / "results/elastic"
    calibration = results / "lab/calibrations/all.json"
    calibration.write_text(calibration.read_text().replace('"estimate": 2.', '"estimate": 3.'))
    (results / "snapshots/A_000.parquet").write_bytes(b"")
    before = states(results)
    files = "results/elastic/lab/calibrations/all.json, results/elastic/snapshots/A_000.parquet"
    remedy = "delete them, or make all again with --forcerun calibration_on_all snapshots"
    line = f"palpate: {files}: are not as their jobs made them; {remedy}"
    command = [sys.executable, "-m", "snakemake", "--snakefile", ROOT / "Snakefile", "--configfile", "study.yaml"]
    for how in (["--unlock"], ["--cores", "1", "-n"], ["--cores", "1"]):
        refused = subprocess.run([*command, *how], cwd=tmp_path, capture_output=True, text=True)
        assert (refused.returncode, refused.stderr.splitlines()[-1]) == (2, line)
    for how in ([], ["--dry-run"]):
        refused = run(tmp_path, "study.yaml", "--cores", "1", *how)
        assert (refused.returncode, refused.stderr.splitlines()[-1]) == (2, line)
    assert states(results) == before
    calibration.unlink()
    forced = ["--forcerun", "snapshots", "--cores", "1"]
    planned = run(tmp_path, "study.yaml", *forced, "--dry-run")
    rules = set(re.findall(r"^(\w+) +\d+$", planned.stdout + planned.stderr, flags=re.MULTILINE))
    assert {"calibration_on_all", "snapshots", "surrogate", "report", "tracking"} <= rules
    subprocess.run([*command, *forced, "--", "results/elastic/snapshots/A_000.parquet"], cwd=tmp_path, check=True)
    made = (undisturbed / "results/elastic/snapshots/A_000.parquet").read_bytes()
    assert (results / "snapshots/A_000.parquet").read_bytes() == made
    other = results / "surrogates"
    assert states(other) == {file: state for file, state in before.items() if file.is_relative_to(other)}


@pytest.mark.faults(before="Snakemake asked for --unlock, for which an installed package has no Snakefile")
@pytest.mark.slow
def test_killed_it_goes_on_by_itself_where_nothing_runs_any_more(folder):
    """`palpate run` is killed, then Snakemake as well; a lock that it did not leave stays."""
    simulated = {key: STUDY[key] for key in STUDY if key not in ("recordings", "laboratory", "calibration")}
    (folder / "study.yaml").write_text(yaml.safe_dump(simulated))
    process = subprocess.Popen([PALPATE, "run", "study.yaml", "--cores", "1"], cwd=folder, start_new_session=True)
    while not list(folder.glob("results/store/*/*.npz")):
        assert process.poll() is None
        time.sleep(0.1)
    (snakemake,) = psutil.Process(process.pid).children()
    process.kill()
    process.wait()
    assert not killed_run.unlocked(folder), "Snakemake goes on"
    beside = run(folder, "study.yaml")
    assert beside.returncode == 1
    assert "locked by another execution, which makes the same results; wait" in beside.stderr.splitlines()[-1]
    os.killpg(snakemake.pid, signal.SIGKILL)
    psutil.wait_procs([snakemake])
    left = killed_run.locks(folder)
    assert left
    found = run(folder, "study.yaml", "--cores", "2")
    assert found.returncode == 0, found.stderr[-3000:]
    assert "the last run was killed; continuing where it stopped" in found.stderr
    assert list((folder / ".snakemake").glob("run_by_palpate*")) == killed_run.locks(folder) == []
    (folder / "results/elastic/report.html").unlink()
    left[0].parent.mkdir(exist_ok=True)
    left[0].write_text("results/elastic/report.html\n")
    found = run(folder, "study.yaml", "--cores", "2")
    assert found.returncode == 1 and "remove .snakemake/locks" in found.stderr.splitlines()[-1]
    assert left[0].is_file()


@pytest.mark.faults(before="old results were called up to date")
@pytest.mark.slow
def test_a_job_that_was_killed_after_a_setting_changed_leaves_nothing_stale(undisturbed, tmp_path):
    """All that rests on a result that is missing is made again, though it lies there from before."""
    shutil.copytree(undisturbed, tmp_path, dirs_exist_ok=True)
    (tmp_path / "results/elastic/lab/calibrations/all.json").unlink()
    planned = run(tmp_path, "study.yaml", "--cores", "1", "--dry-run")
    rules = set(re.findall(r"^(\w+) +\d+$", planned.stdout + planned.stderr, flags=re.MULTILINE))
    assert {"calibration_on_all", "figures", "report", "tracking"} <= rules


@pytest.mark.faults(before="bash: /home/me/My: No such file or directory")
@pytest.mark.slow
def test_a_virtual_environment_in_a_folder_with_a_space_serves(tmp_path):
    """Its Python finds the packages of the one that runs this; Snakemake starts each script with it."""
    environment = tmp_path / "My Lab's environment"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    python, shared = environment / "bin/python", [path for path in sys.path if path.endswith(("site-packages", "src"))]
    (packages,) = environment.glob("lib/python*/site-packages")
    (packages / "shared.pth").write_text("\n".join(shared))
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    table = "results/elastic/snapshots/A_000.parquet"
    command = [python, "-m", "snakemake", table, "--snakefile", ROOT / "Snakefile", "--cores", "1"]
    found = subprocess.run([*command, "--configfile", "study.yaml"], cwd=tmp_path, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr[-3000:]
    assert (tmp_path / table).is_file()


def test_a_wheel_holds_the_workflow(tmp_path):
    """All that the Snakefile includes, and every script that a rule runs."""
    hatchling = pytest.importorskip("hatchling.builders.wheel", reason="hatchling is not installed")
    builder = hatchling.WheelBuilder(str(ROOT))
    (wheel,) = builder.build(directory=str(tmp_path), versions=["standard"])
    names = set(zipfile.ZipFile(wheel).namelist())
    for source in ("workflow/rules/*.smk", "scripts/*.py", "profiles/*/*.yaml", "envs/*.yaml"):
        files = [str(file.relative_to(ROOT)) for file in ROOT.glob(source)]
        assert files and {f"palpate/workflow/{file}" for file in files} <= names
    packages = {file.relative_to(ROOT / "src").parts[0] for file in ROOT.glob("src/*/__init__.py")}
    modules = {str(file.relative_to(ROOT / "src")) for name in packages for file in ROOT.glob(f"src/{name}/**/*.py")}
    assert "indentation_files" in packages and modules <= names
    assert {"palpate/workflow/Snakefile", "palpate/workflow/config/config.yaml", "palpate/py.typed"} <= names
    assert not [name for name in names if name.startswith(("studies", "tests"))]
