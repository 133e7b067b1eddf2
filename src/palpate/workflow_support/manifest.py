"""What a report was made from: versions, seed, the configuration, and checksums of recordings and results."""

from __future__ import annotations

import json
import platform
import subprocess
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from indentation_files.recording_file import recording_files
from palpate.base.checksum import checksum
from palpate.configuration.study_file import Study
from palpate.data.study_recordings import with_stiffness
from palpate.errors import PalpateError
from palpate.workflow_support.result_files import read_json

NAME = "report.manifest.json"
LIBRARIES = ("palpate", "numpy", "scipy", "pandas", "numba", "scikit-learn", "deap", "snakemake", "mlflow")


def of(study: Study, configuration: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what a report of a study is made from, as it is now.

    Parameters
    ----------
    configuration
        The study as it was read.
    folder
        Of the study's results.
    """
    return {
        "seed": study.seed,
        "configuration": without_data(configuration),
        "python": platform.python_version(),
        "libraries": {name: _version(name) for name in LIBRARIES},
        "git_commit": git_commit(),
        "files": {str(file): checksum(file) if file.is_file() else "" for file in files(study, folder)},
    }


def files(study: Study, folder: Path) -> Iterator[Path]:
    """Yield the recordings of a study, its vendor's file, and the results that its report shows."""
    if study.source:
        yield from with_stiffness(Path(study.source["file"]))
    if study.family:
        yield folder / "law.json"
    yield folder / "snapshots.csv"
    yield from recordings(study)
    yield from (evidence.file for evidence in study.evidence)
    for name in study.recordings:
        yield folder / name / "calibration.json"
        yield from (folder / name / "calibrations" / f"{condition_set}.json" for condition_set in study.condition_sets)
        if study.diagnosis.enabled:
            yield folder / name / "diagnosis.json"


def recordings(study: Study) -> Iterator[Path]:
    """Yield the recordings of a study that are there, with the files of their stiffness."""
    for folder in study.recordings.values():
        for file in recording_files(folder):
            yield from with_stiffness(file)


def changed(study: Study, configuration: Mapping[str, Any], folder: Path) -> list[str]:
    """Return, a line each, what is no longer as it was when the report in `folder` was made."""
    if not (folder / NAME).is_file():
        return []
    then = read_json(folder / NAME)
    if not isinstance(then, dict) or not all(isinstance(then.get(key), dict) for key in ("configuration", "files")):
        raise PalpateError(f"{folder / NAME} is damaged; delete it and run the study again")
    lines, now = [], json.loads(json.dumps(without_data(configuration)))
    if now != then["configuration"]:
        keys = [key for key in {**now, **then["configuration"]} if now.get(key) != then["configuration"].get(key)]
        lines.append(f"{', '.join(sorted(keys))} in the study's file changed since {folder / 'report.html'} was made")
    for name, known in then["files"].items():
        if not Path(name).is_file():
            lines.append(f"{name} was deleted since {folder / 'report.html'} was made")
        elif checksum(Path(name)) != known:
            lines.append(f"{name} changed since {folder / 'report.html'} was made")
    added = [name for name in map(str, recordings(study)) if name not in then["files"]]
    return lines + [f"{name} was added since {folder / 'report.html'} was made" for name in added]


def without_data(configuration: Mapping[str, Any]) -> dict[str, Any]:
    """Return a configuration without the place of the vendor's file, which differs from machine to machine."""
    return {key: value for key, value in configuration.items() if key != "data"}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def git_commit() -> str:
    """Return the commit of palpate's own working tree, wherever a study is run; ``unknown`` outside a repository."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return answer.stdout.strip()
