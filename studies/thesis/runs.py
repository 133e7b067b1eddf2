"""A design's curves: what to simulate, each curve labelled, taken from the store of snapshots or computed into it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.configuration.study_file import Study
from palpate.errors import InputError
from palpate.solver import store
from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Run:
    """One curve to simulate.

    Parameters
    ----------
    labels
        What distinguishes it from the others: parameters by name and anything else that JSON can hold.
    specification
        Everything that decides it; ``None`` when the solver does not offer it.
    reason
        Why it cannot be simulated; empty otherwise.
    fallback
        What to simulate in its place if the solver fails, such as the same at standard accuracy.
    """

    labels: Mapping[str, Any]
    specification: Specification | None
    reason: str = ""
    fallback: Specification | None = None

    @classmethod
    def of(cls, labels: Mapping[str, Any], build: Callable[[], Specification]) -> Run:
        """Build the specification; what the solver does not offer becomes a reason."""
        try:
            return cls(labels, build())
        except InputError as error:
            return cls(labels, None, str(error))


@dataclass(frozen=True, eq=False)
class Curves:
    """The curves of a design.

    Attributes
    ----------
    labels
        One table of labels a curve.
    time, load, depth : ndarray, shape (n, points)
        [s], [mN], [nm]; the depth of a run that failed is NaN.
    reasons
        Why each failed; empty where it did not.
    """

    labels: Sequence[Mapping[str, Any]]
    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    reasons: Sequence[str]

    def column(self, name: str) -> np.ndarray:
        """Return one label of every curve (n,)."""
        return np.array([labels[name] for labels in self.labels])

    def matrix(self, names: Iterable[str]) -> np.ndarray:
        """Return several labels of every curve (n, k)."""
        return np.column_stack([self.column(name) for name in names])

    def where(self, **labels: Any) -> Curves:
        """Return the curves that carry these labels."""
        chosen = [k for k, own in enumerate(self.labels) if all(own.get(key) == value for key, value in labels.items())]
        return self.take(chosen)

    def succeeded(self) -> Curves:
        """Return the curves that did not fail."""
        return self.take([k for k, reason in enumerate(self.reasons) if not reason])

    def take(self, rows: Sequence[int]) -> Curves:
        """Return some of the curves."""
        return Curves(
            [self.labels[k] for k in rows],
            self.time[rows],
            self.load[rows],
            self.depth[rows],
            [self.reasons[k] for k in rows],
        )

    @property
    def max_depth(self) -> np.ndarray:
        """Depth at the largest load (n,) [nm], at the end of a hold."""
        last = self.load.shape[1] - 1 - np.argmax(self.load[:, ::-1] >= self.load.max(axis=1, keepdims=True), axis=1)
        return self.depth[np.arange(len(last)), last]

    @property
    def residual_depth(self) -> np.ndarray:
        """Depth at the end of unloading (n,) [nm]."""
        return self.depth[:, -1]

    def save(self, path: str | Path) -> None:
        """Write all curves to one file."""
        meta = json.dumps({"labels": [dict(row) for row in self.labels], "reasons": list(self.reasons)})
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path, time=self.time, load=self.load, depth=self.depth, meta=meta)

    @classmethod
    def load_from(cls, path: str | Path) -> Curves:
        """Read what `save` wrote."""
        with np.load(path) as stored:
            meta = json.loads(stored["meta"].item())
            time, load, depth = stored["time"], stored["load"], stored["depth"]
            return cls(meta["labels"], time, load, depth, meta["reasons"])


@dataclass(frozen=True, eq=False)
class Design:
    """A named set of curves.

    Parameters
    ----------
    runs
        From the checked studies and the outcomes it comes after to the runs.
    after
        Studies of the thesis whose outcome decides the runs.
    material
        ``aluminium`` or ``epoxy``: whose configuration the runs rest on.
    libraries
        Of the extra ``studies``, that lay the runs out.
    """

    runs: Callable[[Mapping[str, Study], Mapping[str, Mapping[str, Any]]], list[Run]]
    after: Sequence[str] = ()
    material: str = "epoxy"
    libraries: Sequence[str] = ()

    @property
    def module(self) -> str:
        """Name of the module that lays the runs out."""
        return getattr(self.runs, "func", self.runs).__module__


def compute(runs: Sequence[Run], folder: Path, report: Callable[[str], None]) -> Curves:
    """Bring the curves of all runs together, simulating those that the store lacks.

    Raises
    ------
    InputError
        When the protocols of the runs differ in their number of points.
    """
    counts = {len(run.specification.protocol.sample_time) for run in runs if run.specification}
    if len(counts) > 1:
        raise InputError(f"the runs have {sorted(counts)} points", remedy="sample all runs of a design equally often")
    first = [run.specification for run in runs]
    _fill(folder, runs, first, report)
    failed = [one is not None and bool(_read(folder, one)["reason"]) for one in first]
    used = [
        run.fallback if lost and run.fallback else run.specification for run, lost in zip(runs, failed, strict=True)
    ]
    _fill(folder, runs, used, report)
    blank = np.full(counts.pop() if counts else 1, np.nan)
    nothing: dict[str, Any] = {"time": blank, "load": blank, "depth": blank}
    found = [
        _read(folder, one) if one else nothing | {"reason": run.reason} for run, one in zip(runs, used, strict=True)
    ]
    labels = [{**run.labels, **_name(one)} for run, one in zip(runs, used, strict=True)]
    time, load, depth = (np.array([row[key] for row in found]) for key in ("time", "load", "depth"))
    return Curves(labels, time, load, depth, [row["reason"] for row in found])


def _name(specification: Specification | None) -> dict[str, str]:
    """Return labels of the curve that was taken: its address in the store and its accuracy."""
    if specification is None:
        return {"address": "", "accuracy": ""}
    return {"address": store.address(specification), "accuracy": specification.accuracy}


def _file(folder: Path, specification: Specification) -> Path:
    return store.place(store.address(specification), folder)


def _read(folder: Path, specification: Specification) -> dict[str, Any]:
    """Return the content of a stored curve; its reason is empty where it did not fail."""
    content = store.read(_file(folder, specification))
    return content | {"reason": "" if content["status"] == "ok" else content["reason"]}


def _fill(
    folder: Path,
    runs: Sequence[Run],
    specifications: Sequence[Specification | None],
    report: Callable[[str], None],
) -> None:
    """Simulate what the store lacks."""
    wanted = {}
    for run, one in zip(runs, specifications, strict=True):
        if one and not _file(folder, one).exists():
            cell = {name: value for name, value in run.labels.items() if name in one.parameters}
            wanted[store.address(one)] = store.Snapshot(cell, str(run.labels.get("condition", "")), one)
    store.fill(list(wanted.values()), store.AT_ONCE, folder, report)


def study_runs(study: Study, points: Iterable[Mapping[str, float]], conditions: Iterable[str]) -> list[Run]:
    """Return runs of a study's material at every point, under the named conditions of the study.

    Where the solver fails at `accuracy: fine`, the standard accuracy takes its place.
    """
    points = list(points)
    return [
        Run(
            {**point, "condition": name},
            study.specification(point, study.condition(name)),
            fallback=study.specification(point, study.condition(name), "standard")
            if study.accuracy == "fine"
            else None,
        )
        for name in conditions
        for point in points
    ]
