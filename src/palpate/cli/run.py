"""``palpate run``: the whole workflow of a study, from any folder, with or without a clone of the repository."""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from palpate.cli import warn
from palpate.errors import InputError, PalpateError

NAME = "run"
HELP = "run a study, from its recordings to its report"
CLONE = Path(__file__).parents[3]
WHEEL = Path(__file__).parents[1] / "workflow"
ROOM = 20 << 20  # bytes of the results of a small study
PATIENCE = 1.0  # s that jobs have to end by themselves after Ctrl-C
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # Ctrl-C, the batch system, a terminal that is closed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("study", type=Path, metavar="STUDY.yaml", help="the study")
    parser.add_argument(
        "--cores", type=_cores, default=os.cpu_count() or 1, metavar="N", help="number of cores (default: all)"
    )
    parser.add_argument("--data", help="the instrument's file, in place of source.file in the study")
    parser.add_argument("--forcerun", nargs="+", default=[], metavar="RULE", help="rules or results to make again")
    parser.add_argument("-n", "--dry-run", action="store_true", help="show what would be done, and do nothing")


def run(arguments: argparse.Namespace) -> int:
    """Check the study, and execute the workflow on it in the present folder; return Snakemake's exit code.

    After Ctrl-C, SIGTERM or SIGHUP nothing goes on; the next run continues where this one stopped, or was killed.
    """
    from palpate.configuration.study_file import load_study
    from palpate.workflow_support import killed_run
    from palpate.workflow_support.check_study import checked

    study = checked(load_study(arguments.study, arguments.data))
    workflow = snakefile()
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(workflow)]
    command += ["--workflow-profile", str(workflow.parent / "profiles/default")]  # else a folder `default` is taken
    command += ["--cores", str(arguments.cores), "--configfile", str(arguments.study)]
    command += ["--config", f"data={_as_text(arguments.data)}"] if arguments.data else []
    command += ["--forcerun", *arguments.forcerun] if arguments.forcerun else []
    command += ["--dry-run"] if arguments.dry_run else []
    if arguments.dry_run:
        return subprocess.run(command, env=_environment(), check=False).returncode
    here = Path.cwd()
    if shutil.disk_usage(here).free < ROOM:
        raise InputError(f"less than {ROOM >> 20} MB of the disk are free", remedy="free space on the disk", file=here)
    if killed_run.unlocked(here):
        warn("the last run was killed; continuing where it stopped")
    if killed_run.locks(here, f"results/{study.name}/"):
        raise PalpateError(f"the folder {here} is locked by {_holder(here)}")
    with killed_run.marked(here):
        return _executed(command)


def _cores(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of cores, 1 or more")
    return value


def _as_text(data: str) -> str:
    """Return the path of data so that Snakemake keeps it as text: of the name 2024 it would make a number."""
    if not os.path.isdir(data):
        try:
            float(data)
        except ValueError:
            return data
    return os.path.join(".", data)


def snakefile() -> Path:
    """Return the workflow: that of the clone this code lies in, or that which was installed with it."""
    return next(folder / "Snakefile" for folder in (CLONE, WHEEL) if (folder / "Snakefile").is_file())


def _holder(folder: Path) -> str:
    """Return what holds the locks of a folder, and the remedy."""
    from palpate.workflow_support import killed_run

    if killed_run.running(folder):
        return "another execution, which makes the same results; wait until it has ended"
    remedy = "where none runs on another machine either, remove .snakemake/locks"
    return f"another execution, or by one that was killed; {remedy}"


def _environment() -> dict[str, str]:
    """Return the environment of an execution, which keeps some files where the user's own folder can be written."""
    from palpate.base import kernel_cache

    kept = None if kernel_cache.usable(kernel_cache.user_cache() / "snakemake") else kernel_cache.kept("cache")
    return os.environ | ({"XDG_CACHE_HOME": str(kept)} if kept else {})


def _executed(command: Sequence[str]) -> int:
    """Return the exit code of an execution, which ends with all of its jobs and its lock when it is interrupted.

    Signals wait until the process is known: one that came while it is begun would leave it behind.
    """
    from palpate.workflow_support import killed_run

    for number in ENDING[1:]:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets it
            signal.signal(number, signal.default_int_handler)
    environment, before = _environment(), signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)

    def unblock() -> None:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)

    process = subprocess.Popen(command, env=environment, start_new_session=True, preexec_fn=unblock)
    try:
        unblock()
        return process.wait()
    except KeyboardInterrupt:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(PATIENCE)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        killed_run.unlocked(Path.cwd())
        raise
