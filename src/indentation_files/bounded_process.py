"""Parsing in a process of its own whose memory and time are bounded.

A damaged or hostile file can make its parser allocate or loop without end, panic or abort. Here that ends the other
process, and the caller gets None.
"""

from __future__ import annotations

import pickle
import resource
import subprocess
import sys
from collections.abc import Callable
from typing import Any

MEMORY = 1 << 30  # bytes
SECONDS = 10  # of the processor
BEYOND = f"it takes more than {MEMORY >> 30} GB or {SECONDS} s to read"


def parsed(script: str, content: bytes, *arguments: str) -> Any:
    """Return what the Python file `script`, which calls `serve`, makes of bytes; None where it came to no end."""
    command = [sys.executable, "-P", script, *arguments]
    try:
        found = subprocess.run(command, input=content, capture_output=True, timeout=2 * SECONDS)
    except subprocess.TimeoutExpired:
        return None
    return None if found.returncode else pickle.loads(found.stdout)


def serve(parse: Callable[[bytes], Any]) -> None:
    """Answer to `parsed`: write what `parse` makes of the bytes on the standard input."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    sys.stdout.buffer.write(pickle.dumps(parse(sys.stdin.buffer.read())))
