"""Many small studies in one results folder, killed at random moments: at the end each must be as if nothing had been.

    python benchmarks/soak.py --studies 50 --seed 1

Every study runs undisturbed in a folder of its own, and beside the others in one folder, where its execution with all
of its jobs is killed (SIGKILL) after a time drawn from a seeded generator, and begun again, until it ends by itself.
Results are compared byte for byte; logs, benchmarks and what is sent to MLflow hold times and are left out.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from palpate.workflow_support import killed_run

ROOT = Path(__file__).parents[1]
APART = ("logs", "benchmarks", "tracking", "mlartifacts", "mlflow.db", "mlflow.db.lock")
KILLS = 2  # of each study
EARLIEST, LATEST = 3.0, 40.0  # s after the start


def study(number: int, recorded: bool = True) -> dict[str, Any]:
    """Return a study of an elastic body under one condition, and the recordings of a virtual laboratory, or none."""
    simulated = {
        "study": f"soak_{number:02d}",
        "seed": number,
        "material": {"model": "elastic", "poisson_ratio": 0.3},
        "parameters": {"youngs_modulus": [2.0, 2.5, 3.0, 3.5]},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "points": 12,
        "cells_per_job": 2,
        "conditions": [{"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30 + number}],
    }
    recordings = {
        "recordings": {"lab": f"results/soak_{number:02d}/recordings/lab"},
        "laboratory": {"lab": {"seed": number, "replicates": 2, "parameters": {"youngs_modulus": 2.8}}},
        "calibration": {"population": 16, "generations": 4},
        "diagnosis": {"enabled": False},
    }
    return simulated | recordings if recorded else simulated


def begun(folder: Path, keys: dict[str, Any], *targets: str) -> subprocess.Popen[str]:
    """Begin an execution of the workflow, with its jobs in a process group of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{keys['study']}.yaml"
    file.write_text(yaml.safe_dump(keys))
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--cores", "2"]
    return subprocess.Popen(
        [*command, *targets, "--configfile", file.name], cwd=folder, start_new_session=True, text=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip


def ended(process: subprocess.Popen[str]) -> None:
    """Wait for an execution; raises `RuntimeError` when it failed."""
    _, words = process.communicate()
    if process.returncode:
        raise RuntimeError(words[-3000:])


def disturbed(folder: Path, keys: dict[str, Any], moments: np.ndarray) -> int:
    """Run a study that is killed at some moments [s]; return how many times it was, before it ended by itself."""
    killed = 0
    for moment in moments:
        process = begun(folder, keys)
        try:
            process.wait(moment)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            killed += 1
            for lock in killed_run.locks(folder):
                lock.unlink()
    ended(begun(folder, keys))
    return killed


def contents(folder: Path, name: str) -> dict[str, bytes]:
    """Return the bytes of a study's results, and of all curves in the store, by name."""
    results = folder / "results"
    files = [*(results / name).rglob("*"), *(results / "store").rglob("*")]
    names = {str(file.relative_to(results)): file for file in files if file.is_file()}
    return {name: file.read_bytes() for name, file in names.items() if not set(APART) & set(Path(name).parts)}


def soak(
    folder: Path, studies: int, seed: int, latest: float = LATEST, recorded: bool = True, kills: int = KILLS
) -> tuple[int, int, list[str]]:
    """Run all studies both ways; return how many kills there were, results compared, and those that differ."""
    rng, killed, compared, differing = np.random.default_rng(seed), 0, 0, list[str]()
    for number in range(studies):
        began, keys = time.monotonic(), study(number, recorded)
        alone, together = folder / f"alone_{number:02d}", folder / "together"
        ended(begun(alone, keys, f"results/{keys['study']}/report.html"))
        times = disturbed(together, keys, rng.uniform(EARLIEST, latest, kills))
        expected, found = contents(alone, keys["study"]), contents(together, keys["study"])
        own = {name for name in found if name.startswith(keys["study"]) or name.endswith(".partial")}
        wrong = sorted(name for name in own | set(expected) if found.get(name) != expected.get(name))
        killed, compared, differing = killed + times, compared + len(expected), differing + wrong
        print(f"study {number}: {times} kills, {len(wrong)} of {len(expected)} files differ, "
              f"{time.monotonic() - began:.0f} s", flush=True)  # fmt: skip
    return killed, compared, differing


def main() -> int:
    """Soak, and say what differs; exit code 1 where anything does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--studies", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--latest", type=float, default=LATEST, help="latest moment of a kill [s]")
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or Path(temporary)
        kills, compared, differing = soak(folder, arguments.studies, arguments.seed, arguments.latest)
    print(f"{arguments.studies} studies, {kills} kills, {compared} files compared, {len(differing)} differ")
    print(*differing, sep="\n")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
