"""The documents' own code: what the site is generated with."""

import importlib.util
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def _loaded():
    found = importlib.util.spec_from_file_location("documents_hooks", DOCS / "hooks.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


HOOKS = _loaded()
