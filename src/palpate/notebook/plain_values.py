"""Values of Python and NumPy as a YAML file would give them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np


def plain(values: Any) -> Any:
    """Return mappings, lists and numbers as a YAML file would give them."""
    if isinstance(values, Mapping):
        return {key: plain(value) for key, value in values.items()}
    if isinstance(values, np.ndarray | np.generic):
        return values.tolist()
    if isinstance(values, list | tuple):
        return [plain(value) for value in values]
    return str(values) if isinstance(values, Path) else values
