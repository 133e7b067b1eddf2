"""Snapshots: simulated curves, each kept under the content of what decides it.

The address of a snapshot is a hash of its specification and of the physics in the source code, docstrings and comments
aside. One store serves all studies. So a new level, condition or study never recomputes a snapshot that exists, and a
job that was killed loses only those it was working on at once. A file that was cut or altered is recognised by the
checksums within it, and simulated again.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from indentation_files.whole_file import written_whole
from palpate.base.checksum import content_checksum
from palpate.base.classes import classes_of
from palpate.base.fingerprint import fingerprint
from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.errors import InputError, PalpateError
from palpate.observables import OBSERVABLES
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.simulation import Simulation, alike, simulate_batch
from palpate.study.specification import Specification, of_equivalent_cone

STORE = Path("results/store")
FIELDS = {"time", "load", "depth", "quantity", "status", "reason", "parameters", "condition"}
CURVES = {"response": "quantity", "time_s": "time", "load_mN": "load", "depth_nm": "depth"}  # columns of a table
AT_ONCE = 2 * LANES  # cells under each condition that are solved together; chosen
LEAST_CELLS = 24  # of a job: seconds of work, so that its start, two seconds, is not most of it
JOBS = 400  # of a large study: Snakemake plans thousands of jobs in minutes, hundreds in seconds


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


@dataclass(frozen=True, eq=False)
class Batch:
    """Snapshots that one job computes.

    Parameters
    ----------
    name
        Unique in the study.
    study
    conditions
        One loading condition, or several that differ in size alone and are simulated together.
    cells
        Material parameters on the grid.
    """

    name: str
    study: Study
    conditions: tuple[Condition, ...]
    cells: tuple[Mapping[str, float], ...]

    @functools.cached_property
    def snapshots(self) -> list[Snapshot]:
        """What is simulated; similar indentations are neighbours in the list.

        Under a pyramid it is the equivalent cone: a search begins on its surrogate, and ends on the pyramid.
        """
        return [self._snapshot(cell, condition) for cell in self.cells for condition in self.conditions]

    @property
    def identity(self) -> str:
        """Hash of what decides the curves: the cells, and the first one's curve under each condition."""
        first = [self._snapshot(self.cells[0], condition).address for condition in self.conditions]
        return content_checksum([first, self.cells])[:24]

    def _snapshot(self, cell: Mapping[str, float], condition: Condition) -> Snapshot:
        return Snapshot(cell, condition.name, of_equivalent_cone(self.study.specification(cell, condition)))


def address(specification: Specification) -> str:
    """Return the address of the curve that `specification` decides: a hash of all its fields and of the physics."""
    decides = {"specification": specification, "physics": fingerprint("palpate.solver.simulation")}
    return content_checksum(decides)[:24]


def plan(study: Study) -> list[Batch]:
    """Divide the snapshots of a study's calibrate conditions into jobs; the plan rests on the configuration alone.

    A study that does not say how many cells a job takes has about `JOBS` jobs, of at least `LEAST_CELLS` cells each.
    """
    cells, groups = study.cells, conditions_by_shape(study)
    size = cells_of_a_job(study, len(groups))
    return [
        Batch(f"{conditions[0].name}_{first // size:03d}", study, tuple(conditions), tuple(cells[first : first + size]))
        for conditions in groups
        for first in range(0, len(cells), size)
    ]


def cells_of_a_job(study: Study, groups: int) -> int:
    """Return how many cells of the grid a job simulates, where conditions form so many groups, see `plan`."""
    return study.cells_per_job or max(LEAST_CELLS, math.ceil(len(study.cells) * groups / JOBS))


def conditions_by_shape(study: Study) -> list[list[Condition]]:
    """Return the calibrate conditions in groups of those that differ in size alone.

    Under a sharp tip a body without a length scale has no size but that of the contact, so that one simulation serves
    all of a group, see `palpate.solver.axisymmetric.similar`.
    """
    cell = study.cells[0]
    tests = [(condition, of_equivalent_cone(study.specification(cell, condition))) for condition in study.calibrated]
    groups = classes_of(tests, lambda first, other: alike(first[1], other[1]))
    return [[condition for condition, _ in members] for members in groups]


def place(address: str, store: Path = STORE) -> Path:
    """Return the file of an address."""
    return store / address[:2] / f"{address}.npz"


def computed(
    snapshots: Sequence[Snapshot],
    store: Path = STORE,
    report: Callable[[str], None] = print,
    solve: Callable[[Sequence[Specification]], Sequence[Simulation]] = simulate_batch,
) -> list[dict[str, Any]]:
    """Return the contents of snapshots as `read` does, computing those that are missing in the store or damaged.

    They are solved `AT_ONCE` at a time under each condition, and written as soon as they are. A cell without one of
    its conditions is solved under all of them, because of those that differ in size alone the first is simulated: what
    was interrupted goes on to the last bit as if it had not been.

    Parameters
    ----------
    snapshots
        What is needed.
    store
        Folder of the curves.
    report
        Called with one line on the progress.
    solve
        Simulates specifications.
    """
    found = {snapshot.address: _intact(place(snapshot.address, store)) for snapshot in snapshots}
    incomplete = {tuple(s.cell.values()) for s in snapshots if found[s.address] is None}
    missing = [snapshot for snapshot in snapshots if tuple(snapshot.cell.values()) in incomplete]
    at_once = AT_ONCE * len({snapshot.condition for snapshot in snapshots})
    fill(missing, at_once, store, report, solve)
    report(f"{len(snapshots)} snapshots, {len(missing)} computed")
    return [(found[s.address] or read(place(s.address, store))) | {"parameters": dict(s.cell)} for s in snapshots]


def fill(
    snapshots: Sequence[Snapshot],
    at_once: int,
    store: Path,
    report: Callable[[str], None],
    solve: Callable[[Sequence[Specification]], Sequence[Simulation]] = simulate_batch,
) -> None:
    """Simulate snapshots, `at_once` at a time, and write those that the store lacks as soon as they are.

    Parameters
    ----------
    snapshots, store, report, solve
        See `computed`.
    """
    for first in range(0, len(snapshots), at_once):
        chosen = snapshots[first : first + at_once]
        simulations = solve([snapshot.specification for snapshot in chosen])
        for snapshot, simulation in zip(chosen, simulations, strict=True):
            file = place(snapshot.address, store)
            if _intact(file) is None:
                write(file, simulation, snapshot.cell, snapshot.condition)
        seconds = sum(simulation.solver_seconds for simulation in simulations)
        report(f"{first + len(chosen)} of {len(snapshots)} snapshots computed, {seconds:.1f} s")


def write(path: Path, simulation: Simulation, cell: Mapping[str, float], condition: str) -> None:
    """Write one snapshot; the file appears whole or not at all.

    Parameters
    ----------
    path
        File that is written.
    simulation
        The curve.
    cell
        Parameters of the material by name.
    condition
        Name of the condition.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        raise InputError("is a folder where a curve is kept", remedy="remove it", file=path)
    with written_whole(path) as partial, partial.open("wb") as stream:
        np.savez(
            stream,
            time=simulation.time,
            load=simulation.load,
            depth=simulation.depth,
            quantity=simulation.quantity,
            status=simulation.status,
            reason=simulation.reason,
            parameters=json.dumps(dict(cell)),
            condition=condition,
            address=path.stem,
        )


def read(path: str | Path) -> dict[str, Any]:
    """Return the content of one snapshot file by name; `parameters` as a dictionary."""
    with np.load(path) as stored:
        found: dict[str, Any] = {key: stored[key] if stored[key].ndim else stored[key].item() for key in stored.files}
    return found | {"parameters": json.loads(found["parameters"])}


def _intact(path: Path) -> dict[str, Any] | None:
    """Return the content of a snapshot file; nothing where it is missing, cut, altered or that of another address."""
    try:
        found = read(path)
    except Exception:  # a damaged archive may raise anything
        return None
    return found if found.keys() >= FIELDS and found.get("address", path.stem) == path.stem else None


def table(snapshots: Sequence[Snapshot], contents: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return a table of snapshots: address, condition, status, reason, parameters and the curves, see `CURVES`."""
    return pd.DataFrame(
        {"address": snapshot.address, "condition": snapshot.condition, "status": found["status"],
         "reason": found["reason"], **snapshot.cell, **{column: found[key] for column, key in CURVES.items()}}
        for snapshot, found in zip(snapshots, contents, strict=True)
    )  # fmt: skip


def curves_under(files: Iterable[str | Path], condition: str) -> list[dict[str, Any]]:
    """Return the contents of the snapshots under one condition, as `computed` does, from files that hold a `table`."""
    found = pd.concat(map(pd.read_parquet, files), ignore_index=True)
    rows = found[found["condition"] == condition].to_dict("records")
    names = [name for name in found if name not in ("address", "condition", "status", "reason", *CURVES)]
    return [
        {"status": row["status"], "reason": row["reason"], "parameters": {name: row[name] for name in names},
         **{key: row[column] for column, key in CURVES.items()}}
        for row in rows
    ]  # fmt: skip


def matrix(contents: Iterable[Mapping[str, Any]], names: Iterable[str]) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return parameters (n, d) and responses (n, points) of the snapshots that succeeded, and why others failed.

    The response is in the unit of its observable.

    Raises
    ------
    PalpateError
        When fewer than two snapshots succeeded.
    """
    names = list(names)
    parameters, curves, failures = [], [], []
    for found in contents:
        if found["status"] == "ok":
            parameters.append([found["parameters"][name] for name in names])
            curves.append(OBSERVABLES[found["quantity"]].of_simulation(SimpleNamespace(**found)))
        else:
            failures.append(f"{found['parameters']}: {found['reason']}")
    if len(curves) < 2:
        raise PalpateError(f"{len(failures)} snapshots failed, the first with: {failures[0] if failures else 'none'}")
    return np.array(parameters), np.array(curves), failures
