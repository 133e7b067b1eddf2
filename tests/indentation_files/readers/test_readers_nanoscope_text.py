"""NanoScope's text exports: extension and retraction side by side; the tip's way is the piezo's less the deflection."""

import numpy as np
import pytest

from indentation_files.readers import ColumnMap, read_vendor_file
from indentation_files.readers.afm import BY_PIEZO
from palpate.draft.stated import Stated
from palpate.errors import InputError

SPRING, COUNT = 0.1, 300  # N/m, points of each direction
WAY = np.linspace(0.0, 1000.0, COUNT)
PRESSED = np.clip(WAY - 600.0, 0.0, None)
FORCE = 2.0 * PRESSED**1.5  # pN
DEFLECTION = FORCE / (1e3 * SPRING)
TIME = 1e-3 * np.arange(2 * COUNT)
HEADER = "".join(
    f'"\\{entry}"\n'
    for entry in (
        "*File list", "*Ciao force image list", "Spring Constant: 0.1", "Tip Radius: 30"
    )
)  # fmt: skip


def both(name, values, unit_last=True):
    """A channel of extension and retraction, by the headings that carry its unit."""
    headings = (f"{name[0]}_{way}_{name[1]}" if unit_last else f"{name[0]}_{name[1]}_{way}" for way in ("Ex", "Rt"))
    return dict(zip(headings, (values, values[::-1]), strict=True))


COLUMNS = {
    "Time_s_Ex": TIME[:COUNT],
    "Time_s_Rt": TIME[COUNT:],
    **both(("Calc_Ramp", "nm"), WAY + DEFLECTION),
    **both(("Defl", "V"), DEFLECTION / 50.0, unit_last=False),
    **both(("Defl", "nm"), DEFLECTION, unit_last=False),
    **both(("Defl", "pN"), FORCE, unit_last=False),
    **both(("Height_Sensor", "nm"), WAY + DEFLECTION, unit_last=False),
    **both(("Separation", "nm"), -WAY, unit_last=False),
}
ORDERED = np.concatenate([WAY, WAY[::-1]])


def read(tmp_path, columns, header="", encoding="utf-8", by=None):
    rows = ["\t".join(f"{value:.9g}" for value in row) for row in zip(*columns.values(), strict=True)]
    (tmp_path / "curve.spm.txt").write_bytes((header + "\n".join(["\t".join(columns), *rows])).encode(encoding))
    (test,) = read_vendor_file(tmp_path / "curve.spm.txt", contact="none", columns=by)
    return test


def without(*words):
    return {name: values for name, values in COLUMNS.items() if not any(word in name for word in words)}


@pytest.mark.parametrize(
    ("columns", "messages"),
    [
        (COLUMNS, ()),
        (without("Separation"), ()),
        (without("Separation", "Height"), (BY_PIEZO,)),
        (COLUMNS | both(("Separation", "nm"), WAY, unit_last=False), ()),
        (COLUMNS | {"Time_s_Rt": TIME[:COUNT]}, ()),
        ({name: values[::-1] if "_Rt" in name else values for name, values in COLUMNS.items()}, ()),
    ],
    ids=["separation", "height", "ramp", "separation grows", "a clock each", "rows against time"],
)
@pytest.mark.parametrize(
    ("header", "encoding"), [("", "utf-8"), (HEADER, "utf-8"), (HEADER.replace('"', ""), "utf-16")]
)
def test_extension_and_retraction_are_one_test(tmp_path, columns, messages, header, encoding):
    test = read(tmp_path, columns, header, encoding)
    assert test.recording.time == pytest.approx(TIME, abs=1e-9)
    assert test.recording.load == pytest.approx(1e-9 * np.concatenate([FORCE, FORCE[::-1]]), rel=1e-6, abs=1e-15)
    assert test.recording.depth == pytest.approx(ORDERED, abs=1e-4)
    assert (test.marked, test.warnings) == (False, messages)
    stated = Stated.by_all([test.metadata])
    assert (stated.spring, stated.radius) == ((pytest.approx(1e-6 * SPRING), 30.0) if header else (None, None))


def test_the_extension_alone_is_read(tmp_path):
    assert read(tmp_path, without("Rt")).recording.depth == pytest.approx(WAY, abs=1e-4)


@pytest.mark.parametrize(
    ("columns", "problem"),
    [
        (without("pN"), "lacks Defl_pN_Ex;"),
        (without("Separation", "Height", "Ramp"), "lacks Separation_nm_Ex;"),
        (without("Time_s_Rt"), "lacks Time_s_Rt;"),
        (COLUMNS | {"Defl_pN_Ex": FORCE[::-1]}, "the extension does not end under load"),
        (COLUMNS | {"Defl_pN_Rt": FORCE}, "the retraction does not begin under load"),
    ],
)
def test_what_is_missing_or_contradicts_itself_is_named(tmp_path, columns, problem):
    with pytest.raises(InputError, match=problem):
        read(tmp_path, columns)


RAMP = "\\*Ciao scan list\n\\Scan rate: 7\n\\*Ciao force list\n\\Scan rate: 2.5\n\\Samps/line: {0} {0}\n{1}"
SPEEDS = "\\Forward vel.: 30\n\\Reverse vel.: 10\n"


@pytest.mark.parametrize(("speeds", "extension"), [("", 0.2), (SPEEDS, 0.1)])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("words", [("Time",), ("Time", "Separation")])
def test_the_scan_rate_gives_the_times_that_a_file_lacks(tmp_path, speeds, extension, backwards, words):
    """A period of 0.4 s; exports write what is measured in extension from contact outwards."""
    columns = {
        name: values[::-1] if backwards and name.endswith("_Ex") else values for name, values in without(*words).items()
    }
    test = read(tmp_path, columns, RAMP.format(COUNT, speeds))
    steps = np.repeat([extension, 0.4 - extension], [COUNT, COUNT - 1]) / COUNT
    assert np.diff(test.recording.time) == pytest.approx(steps, rel=1e-6)
    assert test.recording.depth == pytest.approx(ORDERED, abs=1e-4)
    assert any("by the scan rate in the header" in line for line in test.warnings)


def test_a_ramp_is_counted_inwards_whichever_way_its_rows_run(tmp_path):
    """As NanoScope Analysis exports natively: ramps in the order of time, the extension's deflection against it."""
    ramp = np.linspace(0.0, 1000.0, COUNT)
    bent = 0.25 * np.clip(ramp - 600.0, 0.0, None)
    columns = {
        "Calc_Ramp_Ex_nm": ramp,
        "Calc_Ramp_Rt_nm": ramp[::-1],
        **both(("Defl", "nm"), bent[::-1], unit_last=False),
        **both(("Defl", "pN"), 1e3 * SPRING * bent[::-1], unit_last=False),
    }
    columns |= {"Defl_nm_Rt": bent[::-1], "Defl_pN_Rt": 1e3 * SPRING * bent[::-1]}
    depth = ramp - bent
    test = read(tmp_path, columns, RAMP.format(COUNT, ""))
    assert test.recording.depth == pytest.approx(np.concatenate([depth, depth[::-1]]), abs=1e-4)
    assert test.recording.load == pytest.approx(1e-6 * SPRING * np.concatenate([bent, bent[::-1]]), rel=1e-6, abs=1e-15)


@pytest.mark.parametrize(
    ("header", "problem"),
    [("", "no Scan rate that would give them"), (RAMP.format(512, ""), "300 rows of Ex where its header states")],
)
def test_times_that_the_header_does_not_give_are_not_guessed(tmp_path, header, problem):
    with pytest.raises(InputError, match=problem):
        read(tmp_path, without("Time"), header)


def test_a_text_with_nanoscope_s_header_is_read_by_its_columns_too(tmp_path):
    columns = ColumnMap({"time": "Time_s_Ex", "load": "Defl_pN_Ex", "depth": "Separation_nm_Ex"}, {"depth": "-nm"})
    test = read(tmp_path, COLUMNS, HEADER.replace('"', ""), by=columns)
    assert test.recording.depth == pytest.approx(WAY, abs=1e-4)
