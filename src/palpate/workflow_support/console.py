"""What the terminal shows while a study runs: one line on the progress, what is learnt, and the answer at the end.

The workflow says beforehand what an execution is expected to take (`announce`); the logger plugin tells what begins and
ends. Without a terminal each finished job is a line of its own.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

from palpate.base.rounding import rounded
from palpate.output.results.bulk_errors import bulk_sentences
from palpate.output.results.imprint_errors import imprint_sentences
from palpate.output.results.law_candidates import choice_sentences
from palpate.output.results.misfit import progress
from palpate.workflow_support.expected_time import COMPILING, time_in_words
from palpate.workflow_support.result_files import read_json

OTHER = 1.0  # s, of a job that is not expected to take long
BEGUN = 0.1  # share of the whole from which on its pace decides, and not what was expected


@dataclass(frozen=True)
class Plan:
    """What is known of an execution before it begins.

    Parameters
    ----------
    folder
        Of the study's results.
    seconds
        That a job of each rule is expected to take.
    cores
        On which they run.
    whole
        Returns whether all of the study is asked for, and no other target.
    """

    folder: Path
    seconds: Mapping[str, float]
    cores: int
    whole: Callable[[], bool]


_plans: list[Plan] = []


def announce(plan: Plan) -> None:
    """Keep what is known of the execution of this process."""
    _plans.append(plan)


@dataclass
class Console:
    """The view of one execution.

    Parameters
    ----------
    stream
        Where it is written.
    """

    stream: TextIO
    began: float = field(default_factory=time.monotonic)
    jobs: dict[str, int] = field(default_factory=dict)
    total: int = 0
    running: dict[int, tuple[str, str, Sequence[str]]] = field(default_factory=dict)
    ended: list[str] = field(default_factory=list)
    worst: tuple[float, str] = (0.0, "")
    closed: bool = False
    compiles: bool = False

    @property
    def plan(self) -> Plan | None:
        """What the workflow announced last."""
        return _plans[-1] if _plans else None

    def planned(self, jobs: Mapping[str, int]) -> None:
        """Take the number of jobs of each rule."""
        self.jobs, self.total, self.began = dict(jobs), sum(jobs.values()), time.monotonic()
        self.compiles = bool(self._compiling())
        self.write(f"{self.total} jobs, about {time_in_words(self._left())}{self._compiling()}")

    def started(self, job: int, rule: str, message: str, outputs: Sequence[str]) -> None:
        """Take a job that begins: its rule, the message that people read, and the outputs of which is learnt."""
        self.running[job] = (rule, message, outputs)
        self._show()

    def finished(self, job: int) -> None:
        """Take a job that has ended, and show what is learnt from it."""
        rule, message, outputs = self.running.pop(job, ("", "", ()))
        self.ended.append(rule)
        for line in self._learnt(rule, outputs):
            self.write(line)
        self._show(message)

    def counted(self, total: int) -> None:
        """Take the number of all jobs, which grows where a choice decides on further ones."""
        self.total = max(self.total, total)

    def done(self) -> None:
        """Show the answer of each set of recordings, where all of a study was asked for."""
        if self.closed or not self.plan or not self.plan.whole():
            return
        self.closed = True
        for line in closing_lines(self.plan.folder):
            self.write(line)

    def write(self, text: str) -> None:
        """Write lines of their own, above the line on the progress."""
        if text:
            self.stream.write(f"{self._cleared()}{text}\n")
            self.stream.flush()

    def _cleared(self) -> str:
        return "\r\x1b[K" if self._terminal else ""

    @property
    def _terminal(self) -> bool:
        return bool(getattr(self.stream, "isatty", bool)()) and os.environ.get("TERM") != "dumb"

    def _show(self, ended: str = "") -> None:
        """Write the line on the progress: over the former one, or of the job that ended where there is no terminal."""
        if not self.total or (not self._terminal and not ended):
            return
        left = f", about {time_in_words(self._left())} left" if len(self.ended) < self.total else ""
        doing = "; ".join(message for _, message, _ in self.running.values()) if self._terminal else ended
        line = f"{len(self.ended)} of {self.total} jobs{left}: {doing}{self._compiling()}"
        if self._terminal:
            width = os.get_terminal_size(self.stream.fileno()).columns
            self.stream.write(f"{self._cleared()}{line[: width - 1]}")
            self.stream.flush()
        else:
            self.write(line)

    def _left(self) -> float:
        """Return the time that is left [s]: from what was expected, at the pace of what is done.

        Where kernels were compiled first, what that takes is not counted, and no faster pace than expected.
        """
        whole, done = (sum(map(self._expected, rules)) for rules in (self._rules(), self.ended))
        cores = self.plan.cores if self.plan else 1
        passed, expected = time.monotonic() - self.began, 1.0 / cores
        if self.compiles:
            passed = max(passed - COMPILING, done * expected)
        pace = passed / done if done > BEGUN * whole else expected
        return max(whole - done, 0.0) * pace

    def _rules(self) -> Iterator[str]:
        for rule, count in self.jobs.items():
            yield from [rule] * count

    def _expected(self, rule: str) -> float:
        known = self.plan.seconds if self.plan else {}
        return next((known[name] for name in known if rule.startswith(name)), OTHER)

    def _compiling(self) -> str:
        """Return that kernels are compiled, before the first curves of a machine are known."""
        kept = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
        first = not any(rule.startswith(("snapshots", "laboratory")) for rule in self.ended)
        compiled = kept.is_dir() and any(kept.rglob("*.nbi"))
        return f"; compiling, once, about {time_in_words(COMPILING)}" if first and not compiled else ""

    def _learnt(self, rule: str, outputs: Sequence[str]) -> Iterator[str]:
        """Yield what the results of a job show."""
        results = [Path(file) for file in outputs if file.endswith(".json") and "/tracking/" not in file]
        for file in results:
            if rule == "choose_law":
                yield choice_sentences(read_json(file))
            elif rule == "surrogate":
                found = read_json(file)
                self.worst = max(self.worst, (found[f"loo_rmse_{found['unit']}"], f"{found['unit']}, {file.stem}"))
                if self.ended.count(rule) == self.jobs.get(rule):
                    yield f"worst surrogate error {rounded(self.worst[0], 2)} {self.worst[1]}"
            elif rule.startswith("calibration"):
                found = read_json(file)
                where = f"{file.parents[1].name}, {file.stem}"
                yield f"{where}: {progress(found)}"
                yield from (f"{where}: {text}" for text in bulk_sentences(found.get("uniaxial") or {}))
                yield from (f"{where}: {text}" for text in imprint_sentences(found.get("imprint") or {}))
            elif rule == "diagnosis":
                found = read_json(file)
                named = f": {', '.join(found['mechanisms'])}" if found["mechanisms"] else ""
                yield f"{file.parent.name}: {found['verdict']}{named}"


def closing_lines(folder: Path) -> Iterator[str]:
    """Yield law, verdict, parameters and error of each set of a study, and where more is shown."""
    file = folder / "report.json"
    if not file.is_file():
        return
    for found in read_json(file)["sets"]:
        yield from found["lines"]
    yield f"report      {folder / 'report.html'}; compare runs: palpate ui"
