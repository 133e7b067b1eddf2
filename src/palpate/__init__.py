"""palpate: the law of a material from instrumented indentation, and the physics that a model left out.

From a notebook or a script: ``from palpate import Study, read_recording, simulate, calibrate, diagnose``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from palpate.base import kernel_cache

if TYPE_CHECKING:
    from palpate.notebook.fitted_study import calibrate, diagnose
    from palpate.notebook.measured_test import read_recording, read_recordings
    from palpate.notebook.notebook_study import NotebookStudy as Study
    from palpate.notebook.simulated_curve import simulate

__version__ = "0.1.0"
__all__ = ["Study", "__version__", "calibrate", "diagnose", "read_recording", "read_recordings", "simulate"]

PLACES = {
    "Study": "palpate.notebook.notebook_study.NotebookStudy",
    "calibrate": "palpate.notebook.fitted_study.calibrate",
    "diagnose": "palpate.notebook.fitted_study.diagnose",
    "read_recording": "palpate.notebook.measured_test.read_recording",
    "read_recordings": "palpate.notebook.measured_test.read_recordings",
    "simulate": "palpate.notebook.simulated_curve.simulate",
}

kernel_cache.choose()


def __getattr__(name: str) -> Any:
    """Import what is asked for on its first use (PEP 562), so that ``import palpate`` itself stays fast."""
    if name not in PLACES:
        raise AttributeError(f"module 'palpate' has no attribute {name!r}")
    module, _, attribute = PLACES[name].rpartition(".")
    return getattr(import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted({*globals(), *PLACES})
