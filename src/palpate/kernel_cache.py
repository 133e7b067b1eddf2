"""Where compiled kernels are kept: a folder for each state of their sources.

numba notices a change of the file that a kernel is in, but not of kernels that it calls from other files. So the cache
bears the hash of all sources that hold kernels, and an update of the package never meets machine code of the old one.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

PACKAGE = Path(__file__).parent
SOURCES = ("fem", "fem3d", "materials", "materials/flow")


def choose() -> None:
    """Point numba, before it is imported, at the folder for the present sources; ``NUMBA_CACHE_DIR`` overrules it."""
    digest = hashlib.sha256()
    for folder in SOURCES:
        for file in sorted((PACKAGE / folder).glob("*.py")):
            digest.update(file.read_bytes())
    os.environ.setdefault("NUMBA_CACHE_DIR", str(PACKAGE / "__pycache__" / f"kernels-{digest.hexdigest()[:12]}"))
