"""Snapshots: simulated curves, each kept under the content of what decides it.

The address of a snapshot is a hash of its specification and of the physics in the source code, docstrings and comments
aside. One store serves all studies; a study's own folder holds hard links into it. So a new level, condition or study
never recomputes a snapshot that exists, and a job that was killed loses only those it was working on at once.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from palpate.base.fingerprint import content, fingerprint
from palpate.configuration.study_file import Condition, Study
from palpate.errors import PalpateError
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.simulation import Simulation, alike, simulate_batch
from palpate.study.specification import Specification, of_equivalent_cone

AT_ONCE = 2 * LANES


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One (grid cell, loading condition) of a study.

    Parameters
    ----------
    cell
        Material parameters on the grid.
    condition
        Name of the loading condition.
    specification
        Everything that decides the curve.
    """

    cell: Mapping[str, float]
    condition: str
    specification: Specification

    @functools.cached_property
    def address(self) -> str:
        """Hash of everything that decides the curve."""
        return address(self.specification)


@dataclass(frozen=True)
class Batch:
    """Snapshots that one job computes.

    Parameters
    ----------
    name
        Unique in the study.
    snapshots
        What to simulate, under one loading condition or several that differ in size alone; what is alike stands
        together.
    files
        Target of each snapshot, in the same order.
    """

    name: str
    snapshots: tuple[Snapshot, ...]
    files: tuple[str, ...]

    def under(self, condition: str) -> list[str]:
        """Return the files of one loading condition."""
        return [
            file for snapshot, file in zip(self.snapshots, self.files, strict=True) if snapshot.condition == condition
        ]


def address(specification: Specification) -> str:
    """Return the address of the curve that `specification` decides: a hash of all its fields and of the physics."""
    decides = {"specification": content(specification), "physics": fingerprint("palpate.solver.simulation")}
    return hashlib.sha256(json.dumps(decides, sort_keys=True).encode()).hexdigest()[:24]


def plan(study: Study, results: Path = Path("results")) -> list[Batch]:
    """Divide the snapshots of a study's calibrate conditions into jobs; the plan rests on the configuration alone.

    Of a pyramid they are the equivalent cone's: on their surrogate a search begins, and ends on the pyramid itself.
    """
    batches = []
    for conditions in conditions_by_shape(study):
        members = [
            Snapshot(cell, condition.name, of_equivalent_cone(study.specification(cell, condition)))
            for cell in study.cells
            for condition in conditions
        ]
        folder = results / study.name / "snapshots"
        batches += divided(conditions[0].name, members, folder, study.cells_per_job * len(conditions))
    return batches


def conditions_by_shape(study: Study) -> list[list[Condition]]:
    """Return the calibrate conditions, together those that differ in size alone.

    Under a sharp tip a body without a length knows no size but that of the contact, so that one simulation serves them
    all, see `palpate.solver.axisymmetric.similar`.
    """
    groups: list[list[Condition]] = []
    for condition in study.conditions:
        if condition.role == "calibrate":
            specification = of_equivalent_cone(study.specification(study.cells[0], condition))
            first = [of_equivalent_cone(study.specification(study.cells[0], group[0])) for group in groups]
            same = [group for group, other in zip(groups, first, strict=True) if alike(other, specification)]
            if same:
                same[0].append(condition)
            else:
                groups.append([condition])
    return groups


def divided(name: str, members: Sequence[Snapshot], folder: Path, per_job: int) -> list[Batch]:
    """Divide snapshots into jobs of `per_job`, whose targets lie in `folder`, in one for each condition."""
    parts = [tuple(members[first : first + per_job]) for first in range(0, len(members), per_job)]
    return [
        Batch(f"{name}_{number:03d}", part, tuple(str(folder / m.condition / f"{m.address}.npz") for m in part))
        for number, part in enumerate(parts)
    ]


def compute(
    batch: Batch,
    results: Path = Path("results"),
    report: Callable[[str], None] = print,
    solve: Callable[[Sequence[Specification]], Sequence[Simulation]] = simulate_batch,
) -> int:
    """Bring every snapshot of a batch into the study's folder, computing those that the store lacks.

    They are solved `AT_ONCE` at a time under each condition, and written as soon as they are.

    Returns
    -------
    int
        Number of snapshots computed.
    """
    stored = [results / "store" / Path(file).stem[:2] / Path(file).name for file in batch.files]
    missing = [number for number, file in enumerate(stored) if not file.exists()]
    at_once = AT_ONCE * len({snapshot.condition for snapshot in batch.snapshots})
    for first in range(0, len(missing), at_once):
        chosen = missing[first : first + at_once]
        simulations = solve([batch.snapshots[number].specification for number in chosen])
        for number, simulation in zip(chosen, simulations, strict=True):
            snapshot = batch.snapshots[number]
            write(stored[number], simulation, snapshot.cell, snapshot.condition)
        report(f"{batch.name}: {first + len(chosen)} of {len(missing)} snapshots computed")
    for file, kept in zip(batch.files, stored, strict=True):
        link(kept, Path(file))
    report(f"{batch.name}: {len(batch.files)} snapshots, {len(missing)} computed")
    return len(missing)


def write(path: Path, simulation: Simulation, cell: Mapping[str, float], condition: str) -> None:
    """Write one snapshot; the file appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{os.getpid()}.partial")
    with partial.open("wb") as stream:
        np.savez(
            stream,
            time=simulation.time,
            load=simulation.load,
            depth=simulation.depth,
            quantity=simulation.quantity,
            status=simulation.status,
            reason=simulation.reason,
            solver_seconds=simulation.solver_seconds,
            parameters=json.dumps(dict(cell)),
            condition=condition,
        )
    partial.replace(path)


def link(stored: Path, path: Path) -> None:
    """Put a stored snapshot where the study looks for it: a hard link, or a copy where links cannot be made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    try:
        os.link(stored, path)
    except OSError:
        shutil.copyfile(stored, path)


def read(path: str | Path) -> dict[str, Any]:
    """Return the content of one snapshot file by name; `parameters` as a dictionary."""
    with np.load(path) as stored:
        content: dict[str, Any] = {key: stored[key] if stored[key].ndim else stored[key].item() for key in stored.files}
    content["parameters"] = json.loads(content["parameters"])
    return content


def index(files: Iterable[str | Path]) -> pd.DataFrame:
    """Return a table of snapshots: address, condition, status, reason, solver seconds and parameters."""
    rows = []
    for file in files:
        content = read(file)
        keep = {key: content[key] for key in ("condition", "status", "reason", "solver_seconds")}
        rows.append({"address": Path(file).stem, **keep, **content["parameters"]})
    return pd.DataFrame(rows)


def matrix(files: Iterable[str | Path], names: Iterable[str]) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return parameters (n, d) and answers (n, points) of the snapshots that succeeded, and the reasons of the others.

    What answers is the depth [nm], or under displacement control the load [mN].

    Raises
    ------
    PalpateError
        When fewer than two snapshots succeeded.
    """
    names = list(names)
    parameters, curves, failures = [], [], []
    for file in files:
        content = read(file)
        if content["status"] == "ok":
            parameters.append([content["parameters"][name] for name in names])
            curves.append(content[content["quantity"]])
        else:
            failures.append(f"{content['parameters']}: {content['reason']}")
    if len(curves) < 2:
        raise PalpateError(f"{len(failures)} snapshots failed, the first with: {failures[0] if failures else 'none'}")
    return np.array(parameters), np.array(curves), failures
