"""A study small enough to be run from its file to its report, and Snakemake on it."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

import yaml
from snakemake import cli

ROOT = Path(__file__).parents[2]
TRUTH = {
    "youngs_modulus": 3.2,
    "steady_coefficient": 0.08,
    "steady_exponent": 0.2,
    "transient_coefficient": 0.24,
    "retardation_time": 0.25,
}
TINY = {
    "study": "tiny",
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34, "transient_exponent": 0.4},
    "parameters": {
        "youngs_modulus": [3.0, 3.5],
        "steady_coefficient": [0.05, 0.1],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.24],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "points": 20,
    "cells_per_job": 2,
    "conditions": [
        {"name": "T030", "max_load": 1.0, "loading_time": 30, "unloading_time": 30},
        {"name": "T100", "max_load": 1.0, "loading_time": 100, "unloading_time": 100},
        {"name": "V030", "max_load": 0.5, "loading_time": 30, "unloading_time": 30, "role": "validate"},
    ],
    "condition_sets": {"fast": ["T030"]},
    "recordings": {
        "virtual": "results/tiny/recordings/virtual",
        "concealed": "results/tiny/recordings/concealed",
    },
    "calibration": {"population": 20, "generations": 10},
    "diagnosis": {"mechanisms": ["thermal_drift", "controller_lag", "size_effect"], "bootstrap": 400},
    "laboratory": {
        "virtual": {"seed": 1, "parameters": TRUTH},
        "concealed": {"seed": 2, "parameters": TRUTH, "mechanisms": {"thermal_drift": {"rate": 0.5}}},
    },
}


def snakemake(folder, *arguments, study=None):
    (folder / "study.yaml").write_text(yaml.safe_dump(study or TINY))
    return execute(folder, *arguments, "--configfile", "study.yaml")


def execute(folder, *arguments):
    if "--dry-run" in arguments:
        return planned_in_a_fork(folder, ["--cores", "2", *arguments])
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]
    environment = {key: value for key, value in os.environ.items() if key != "MLFLOW_TRACKING_URI"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


def planned_in_a_fork(folder, arguments):
    """Return what Snakemake plans, in a copy of this process, which has imported all that it needs."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        child = os.fork()
        if child == 0:
            code = 1
            try:
                os.chdir(folder)
                os.dup2(out.fileno(), 1)
                os.dup2(err.fileno(), 2)
                sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
                sys.argv = ["snakemake", *arguments]
                cli.main(arguments)
            except SystemExit as leaving:
                code = leaving.code or 0
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(code)
        _, status = os.waitpid(child, 0)
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read())
    return subprocess.CompletedProcess(arguments, os.waitstatus_to_exitcode(status), *texts)


def copied(folder, *further):
    for name in ("Snakefile", "workflow", "profiles", "scripts", "envs", *further):
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / name)
    return folder


def planned(folder, *targets, study):
    """Return the rules that would run."""
    run = snakemake(folder, *targets, "--dry-run", "--quiet", "host", study=study)
    assert run.returncode == 0, run.stderr[-3000:]
    counted = re.findall(r"^(\w+) +\d+$", run.stdout + run.stderr, flags=re.MULTILINE)
    return set(counted) - {"total"}
