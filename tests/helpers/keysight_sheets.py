"""Sheets of one test each, as two programs of Keysight's indenters write them."""

import numpy as np
from workbooks import write_workbook

from indentation_files.recording_file import read_recording
from palpate.cli.main import main

TIME = np.linspace(-20, 60, 801)
LOAD = np.interp(TIME, [0, 30, 60], [0, 5, 0.2]) + 1e-4 * np.sin(np.arange(801) ** 2)
DEPTH = np.interp(TIME, [-20, 0, 30, 60], [-400, 0, 500, 300])
XP_NAMES = ("Time On Sample", "Load On Sample", "Displacement Into Surface", "Raw Displacement", "Raw Load",
            "Frame Stiffness")  # fmt: skip


def kla(marker="Surface Index", row=200, spelt=float, peak=1.0):
    """A sheet of a test with 20 s of approach."""
    marked = [[marker if k == row else None] for k in range(len(TIME))]
    values = zip(marked, TIME + 20, peak * LOAD, DEPTH, strict=True)
    rows = [[*mark, *map(spelt, map(float, numbers))] for mark, *numbers in values]
    return [["Markers", "Time", "Load", "Depth"], [None, "s", "mN", "nm"], *rows]


def xp(peak=1.0, frame=5e6, touched=True):
    """A sheet whose raw displacement has 0.2 nm/mN of frame and 0.5 nm/s of drift."""
    time = TIME if touched else TIME - 100
    raw = DEPTH + 0.2 * peak * LOAD + 0.5 * TIME
    rows = np.column_stack([time, peak * LOAD, DEPTH, raw, peak * LOAD, np.full(len(TIME), frame)])
    return [list(XP_NAMES), ["s", "mN", "nm", "nm", "mN", "N/m"], *rows.tolist()]


def run(tmp_path, sheets, *options):
    """Return the exit code of `palpate read` on a workbook and the largest load of each test that it wrote, by name."""
    file = write_workbook(tmp_path / "x.xlsx", sheets)
    status = main(["read", str(file), *options, "-o", str(tmp_path / "out")])
    return status, {path.stem: round(read_recording(path).load.max()) for path in (tmp_path / "out").glob("*.csv")}
