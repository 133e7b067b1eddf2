"""``palpate ui``: MLflow's pages on the runs of the studies of this folder."""

from __future__ import annotations

import argparse
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import suppress
from pathlib import Path

from palpate.errors import InputError

NAME = "ui"
HELP = "open the comparison of runs in MLflow"
PORT = 5000
PORTS = 100  # that are tried where no port is given
REQUEST = 5  # s that one request may take


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--results", type=Path, metavar="FOLDER", help="the folder of results (default: results)")
    parser.add_argument("--port", type=int, help=f"where MLflow listens (default: {PORT} or the next free one)")


def run(arguments: argparse.Namespace) -> int:
    """Print the link of each study's comparison, once MLflow answers on the store, unless a server is named.

    Raises
    ------
    InputError
        When there is no store yet, or the port is not free.
    """
    from palpate.workflow_support.saved_view import link
    from palpate.workflow_support.tracking import LIMITS, experiments, store_of

    results = arguments.results or Path("results")
    store = store_of(results)
    studies = experiments(results)
    served = store.startswith(("http://", "https://"))
    port = None if served else _free(arguments.port)
    server = store if served else f"http://127.0.0.1:{port}"
    links = [f"{study}: {link(server, identity)}" for study, identity in studies.items()]
    if served:
        print(*links, sep="\n")
        return 0
    print("MLflow starts, which takes some seconds", flush=True)
    command = ["-m", "mlflow", "ui", "--backend-store-uri", store, "--port", str(port), "--workers", "1"]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    log = results / "ui.log"
    with log.open("w") as said:
        process = subprocess.Popen(
            [sys.executable, *command], env=os.environ | LIMITS, stdout=said, stderr=said, start_new_session=True
        )
    try:
        if _answers(process, f"{server}/health"):
            print(*links, f"Ctrl-C ends it; what MLflow says is in {log}", sep="\n", flush=True)
        else:
            print(f"palpate: MLflow has ended; {log} says why", file=sys.stderr)
        return process.wait()
    finally:  # however this command ends: MLflow's own processes would keep the port
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGTERM)
        process.wait()


def _answers(process: subprocess.Popen[bytes], address: str) -> bool:
    """Wait until a server answers, and return whether it does; it does not where its process has ended."""
    while process.poll() is None:
        try:
            urllib.request.urlopen(address, timeout=REQUEST).close()
            return True
        except OSError:
            time.sleep(0.5)
    return False


def _free(port: int | None) -> int:
    """Return a port of this machine on which nothing listens."""
    for each in [port] if port else range(PORT, PORT + PORTS):
        with socket.socket() as found:
            if found.connect_ex(("127.0.0.1", each)) != 0:
                return each
    raise InputError("something listens there already", remedy="give another --port", place="--port")
