"""JPK's text exports: the tip is the height plus the cantilever's deflection, force is spring constant times it."""

import numpy as np
import pytest

from indentation_files.readers import read_vendor_file
from palpate.draft.stated import Stated
from palpate.errors import InputError

SPRING, SENSITIVITY = 0.05, 7e-8  # N/m, m/V
COUNT = 400
TIME = np.linspace(0.0, 2.0, COUNT, endpoint=False)
PRESSED = np.clip(np.interp(TIME, [0.0, 1.0, 2.0], [-2e-6, 1e-6, -2e-6]), 0.0, None)
FORCE = 2e-9 * (PRESSED / 1e-6) ** 1.5
TIP = 6e-5 - np.interp(TIME, [0.0, 1.0, 2.0], [-2e-6, 1e-6, -2e-6])
COLUMNS = {
    "verticalTipPosition": ("m", TIP),
    "vDeflection": ("N", FORCE),
    "strainGaugeHeight": ("m", TIP - FORCE / SPRING),
    "seriesTime": ("s", TIME),
    "time": ("s", np.where(TIME < 1.0, TIME, TIME - 1.0)),
}


def export(names, columns=COLUMNS, facts=None):
    """Text of an extending and a retracting segment with some of the columns, and entries of their headers."""
    lines = ["# TEXT EXPORT", "# data-description.comment: no comment entry"]
    stated = {"springConstant": SPRING, "sensitivity": SENSITIVITY} if facts is None else facts
    for number, (kind, rows) in enumerate((("extend", slice(0, 200)), ("retract", slice(200, COUNT)))):
        lines += ["# index: -1", "#", f"# segmentIndex: {number}", f"# segment: {kind}"]
        lines += [f"# columns: {' '.join(names)}", f"# units: {' '.join(columns[name][0] for name in names)}"]
        lines += [*(f"# {key}: {value}" for key, value in stated.items()), "#"]
        data = np.column_stack([columns[name][1][rows] for name in names])
        lines += [*(" ".join(f"{value:.9g}" for value in row) for row in data), ""]
    return "\n".join(lines)


def read(tmp_path, text):
    file = tmp_path / "curve.txt"
    file.write_text(text)
    (test,) = read_vendor_file(file, contact="none")
    return test


@pytest.mark.parametrize(
    "names",
    [
        ("verticalTipPosition", "vDeflection", "strainGaugeHeight", "seriesTime", "time"),
        ("strainGaugeHeight", "vDeflection", "seriesTime"),
        ("vDeflection", "time", "strainGaugeHeight"),
    ],
    ids=["tip", "height", "a clock for each segment"],
)
def test_the_tip_s_way_the_force_and_the_time_are_read(tmp_path, names):
    test = read(tmp_path, export(names))
    assert test.recording.time == pytest.approx(TIME, abs=1e-9)
    assert test.recording.load == pytest.approx(1e3 * FORCE, rel=1e-6)
    assert test.recording.depth == pytest.approx(1e9 * (TIP[0] - TIP), abs=0.01)
    assert Stated.by_all([test.metadata]).spring == pytest.approx(1e-6 * SPRING)
    assert (test.marked, test.warnings) == (False, ())


@pytest.mark.parametrize(
    ("unit", "deflection"), [("m", FORCE / SPRING), ("µm", 1e6 * FORCE / SPRING), ("V", FORCE / SPRING / SENSITIVITY)]
)
def test_a_deflection_is_brought_to_a_force_by_what_the_header_states(tmp_path, unit, deflection):
    columns = COLUMNS | {"vDeflection": (unit, deflection)}
    names = ("vDeflection", "strainGaugeHeight", "seriesTime")
    assert read(tmp_path, export(names, columns)).recording.load == pytest.approx(1e3 * FORCE, rel=1e-6)
    for facts, missing in (({}, "states no spring constant"), ({"springConstant": SPRING}, "no sensitivity")):
        if unit == "V" or not facts:
            with pytest.raises(InputError, match=missing):
                read(tmp_path, export(names, columns, facts))


def test_without_times_the_duration_of_each_segment_is_taken_and_reported(tmp_path):
    facts = {"springConstant": SPRING, "traceScanTime": 1.0, "retraceScanTime": 1.0}
    names = ("vDeflection", "strainGaugeHeight")
    test = read(tmp_path, export(names, facts=facts))
    assert test.recording.time == pytest.approx(TIME, abs=1e-9)
    assert any("spread evenly" in message for message in test.warnings)
    with pytest.raises(InputError, match="no duration"):
        read(tmp_path, export(names, facts={"springConstant": SPRING}))


def test_a_height_of_the_piezo_is_reported(tmp_path):
    columns = COLUMNS | {"height": COLUMNS["strainGaugeHeight"]}
    test = read(tmp_path, export(("height", "vDeflection", "seriesTime"), columns))
    assert any("piezo" in message for message in test.warnings)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("# TEXT EXPORT\n# columns: height\n# units: m\n#\n", "holds no measured values"),
        ("# TEXT EXPORT\n#\n1 2 3\n", "does not name each column with a unit"),
        (export(("strainGaugeHeight", "seriesTime")), "lacks the column vDeflection"),
        (export(("vDeflection", "seriesTime")), "lacks the column strainGaugeHeight"),
        (export(("vDeflection", "strainGaugeHeight", "seriesTime"), facts={}), "the way of the tip is not known"),
    ],
)
def test_what_is_missing_is_named(tmp_path, text, problem):
    with pytest.raises(InputError, match=problem):
        read(tmp_path, text)
