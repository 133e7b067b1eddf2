"""The test that the readers' tables hold, and maps of their columns."""

import numpy as np

from indentation_files.readers import ColumnMap

TIME = np.linspace(0, 60, 61)
FORCE = 1e3 * np.interp(TIME, [0, 30, 60], [0, 2, 0])
PATH = 0.25 * np.sqrt(FORCE / 2e3) + 0.001 * TIME
NUMBERED = ColumnMap({"time": "1", "load": "2", "depth": "3"})
SHORT = ColumnMap({"time": "t", "load": "P", "depth": "h"}, {"time": "s", "load": "mN", "depth": "nm"})
