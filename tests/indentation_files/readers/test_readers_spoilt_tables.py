"""Tables in which a number, a name, a unit or a sheet is not what it seems: read as meant, reported, or refused."""

import zipfile

import numpy as np
import pytest
from tables import FORCE, NUMBERED, PATH, TIME
from workbooks import write_workbook

from indentation_files.readers import ColumnMap, Unreadable, read_each, read_vendor_file
from palpate.cli.main import main
from palpate.errors import InputError

NAMES = ("Time (s)", "Load (uN)", "Depth (um)")
NAMED = ColumnMap(dict(zip(("time", "load", "depth"), NAMES, strict=True)))
BARE = ColumnMap({"time": "Time", "load": "Load", "depth": "Depth"})


def table(names=NAMES, time=TIME, load=FORCE, depth=PATH, write="{:.6f}".format, between="\t"):
    columns = [[value if isinstance(value, str) else write(value) for value in c] for c in (time, load, depth)]
    rows = list(zip(*columns, strict=True))
    return "\n".join(between.join(row) for row in [names, *rows])


def read(tmp_path, text, columns=NAMED):
    (tmp_path / "x.txt").write_text(text, encoding="utf-8")
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=columns, contact="none")
    return test


def check(test, without=0, before=0.0):
    assert len(test.recording) == len(TIME) - without
    for values, meant in (
        (test.recording.time, TIME),
        (test.recording.load, 1e-3 * FORCE),
        (test.recording.depth - before, 1e3 * PATH),
    ):
        assert values == pytest.approx(np.interp(test.recording.time, TIME, meant), abs=0.05)


def test_a_minus_of_unicode_s_is_a_sign(tmp_path):
    test = read(tmp_path, table(depth=[f"{value:.6f}".replace("-", "−") for value in PATH - 0.5]))
    check(test, before=-500.0)
    assert not test.warnings


def test_blanks_may_part_thousands_where_tabs_part_cells(tmp_path):
    check(read(tmp_path, table(load=[f"{value:,.3f}".replace(",", " ") for value in FORCE])))


def test_a_clock_may_count_down_to_the_contact(tmp_path):
    clock = [f"{'-' if t < 10 else ''}00:00:{abs(t - 10):06.3f}" for t in TIME]
    check(read(tmp_path, table(("Time", *NAMES[1:]), time=clock), NUMBERED))


@pytest.mark.parametrize("channel", ["load", "depth"])
def test_a_zero_that_drops_out_is_left_out(tmp_path, channel):
    values = {"load": FORCE, "depth": PATH}[channel].copy()
    values[[20, 30, 40]] = 0.0
    test = read(tmp_path, table(**{channel: values}))
    check(test, without=3)
    assert any("no three numbers" in warning for warning in test.warnings)


def test_zeros_of_a_load_that_waves_about_zero_are_kept(tmp_path):
    wave = np.round(2 * np.sin(TIME), 0)
    assert (wave[1:-1] == 0).any()
    assert len(read(tmp_path, table(load=np.where(TIME < 40, wave, FORCE))).recording) == len(TIME)


@pytest.mark.parametrize("mark", ["# ", "#", "% ", "%"])
@pytest.mark.parametrize("between", ["\t", ";", ",", "   "])
def test_the_sign_of_a_comment_before_the_header_is_none_of_its_names(tmp_path, mark, between):
    check(read(tmp_path, mark + table(between=between)))


def test_names_are_compared_by_single_blanks(tmp_path):
    check(read(tmp_path, table(("Time  (s)", " Load (uN) ", "Depth   (um)"))))


def test_a_remark_beside_a_row_tears_no_cells(tmp_path):
    lines = table().split("\n")
    lines[30] += "\thold begins"
    check(read(tmp_path, "\n".join(lines)))


@pytest.mark.parametrize(
    "names",
    [
        ("Время, с", "Нагрузка, мкН", "Глубина, мкм"),
        ("Время (сек.)", "Сила (мкН)", "Глубина (мкм)"),
        ("Tiempo (segundos)", "Fuerza (micronewtons)", "Profundidad (micrómetros)"),
        ("Tempo (secondi)", "Forza (micronewton)", "Profondità (micrometri)"),
        ("TimeSec", "loadMicronewton", "depthUm"),
    ],
)
def test_units_of_other_languages_and_within_a_name_are_read(tmp_path, names):
    check(read(tmp_path, table(names), NUMBERED))


@pytest.mark.parametrize("names", [("Time", "loadN", "Depth"), ("Time (s)", "Load (МН)", "Depth (um)")])
def test_what_may_be_another_unit_is_asked_for(tmp_path, names):
    with pytest.raises(InputError, match="--units load=UNIT"):
        read(tmp_path, table(names), NUMBERED)


@pytest.mark.parametrize(
    ("above", "below"),
    [
        (["Units: time in s, load in uN, depth in um"], []),
        (["Load unit\tuN"], []),
        ([], ["Load in uN, depth in um"]),
        (["Einheit der Kraft: µN"], []),
    ],
)
def test_a_unit_is_not_assumed_against_the_file_s_words(tmp_path, above, below):
    text = "\n".join([*above, table(("Time", "Load", "Depth")), *below])
    with pytest.raises(InputError, match=r"Load has no unit beside it, and .* says uN; state it by --units load=UNIT"):
        read(tmp_path, text, BARE)
    units = {"time": "s", "load": "uN", "depth": "um"}
    check(read(tmp_path, text, ColumnMap(BARE.names, units)))


@pytest.mark.parametrize("words", ["Max load 9 N", "Load unit\tmN", "Units of load and of depth are usual"])
def test_other_words_about_a_channel_do_no_harm(tmp_path, words):
    test = read(tmp_path, words + "\n" + table(("Time", "Load", "Depth")), BARE)
    assert test.recording.load.max() == pytest.approx(FORCE.max())


def test_the_title_of_a_row_of_units_is_no_unit(tmp_path):
    rows = "Y_Unit_Label\tMicronewtons\tMicrometers\nX0\t0.0\t0.0\n" + table(("X_Value", "Force", "Disp"))
    check(read(tmp_path, rows, ColumnMap({"time": "X_Value", "load": "Force", "depth": "Disp"})))


@pytest.mark.parametrize(("begin", "unit", "name"), [(1.7e12, 1e3, "ms"), (45356.9, 1 / 86400, "d")])
def test_a_calendar_s_times_are_not_taken_as_seconds(tmp_path, begin, unit, name):
    text = table(("Stamp", *NAMES[1:]), time=begin + unit * TIME, write="{:.15g}".format)
    with pytest.raises(InputError, match=r"column 1: has no unit beside it; it begins at"):
        read(tmp_path, text, NUMBERED)
    check(read(tmp_path, text, ColumnMap(NUMBERED.names, {"time": name})))


def hide(file, name):
    parts = zipfile.ZipFile(file)
    texts = {part: parts.read(part) for part in parts.namelist()}
    parts.close()
    shown = f'name="{name}"'.encode()
    texts["xl/workbook.xml"] = texts["xl/workbook.xml"].replace(shown, shown + b' state="hidden"')
    with zipfile.ZipFile(file, "w") as archive:
        for part, text in texts.items():
            archive.writestr(part, text)
    return file


def rows(scale=1.0, empty=0):
    body = np.column_stack([TIME, scale * FORCE, PATH]).tolist()
    return [[""] * empty + row for row in ([*NAMES], *body)]


def test_a_hidden_sheet_is_left_out_and_named(tmp_path, capsys):
    file = hide(write_workbook(tmp_path / "x.xlsx", {"new": rows(), "old": rows(3.0), "notes": [["x"]]}), "old")
    test, hidden = read_each(file, columns=NAMED, contact="none")
    check(test)
    assert isinstance(hidden, Unreadable)
    columns = ",".join(f"{key}={name}" for key, name in NAMED.names.items())
    assert main(["read", str(file), "--columns", columns, "-o", str(tmp_path / "out")]) == 0
    assert "sheet old: is hidden in the workbook" in capsys.readouterr().err
    only = hide(write_workbook(tmp_path / "y.xlsx", {"old": rows(), "notes": [["x"]]}), "old")
    with pytest.raises(InputError, match=r"hidden sheets, which are left out: old"):
        read_vendor_file(only, columns=NAMED)


def test_columns_of_a_sheet_are_counted_from_its_first_be_it_empty(tmp_path):
    file = write_workbook(tmp_path / "x.xlsx", {"s": rows(empty=2)})
    (test,) = read_vendor_file(file, columns=ColumnMap({"time": "3", "load": "4", "depth": "5"}), contact="none")
    check(test)
