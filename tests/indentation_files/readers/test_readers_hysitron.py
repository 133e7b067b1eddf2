"""Hysitron's two formats: blank cells, headings and headers as other hands write them, contact before small cycles."""

import numpy as np
import pytest

from indentation_files.readers import read_vendor_file
from indentation_files.readers.vendor import contact
from palpate.cli.main import main
from palpate.draft.stated import coefficients
from palpate.errors import InputError

TIME = np.linspace(0, 20, 401)
LOAD = np.interp(TIME, [0, 5, 10, 15, 20], [-0.002, -0.002, 5, 5, 0.5])
DEPTH = 10 + 100 * np.sqrt(np.clip(LOAD, 0, None))
RAW = frozenset()


def text(headings="Depth (nm)\tLoad (µN)\tTime (s)", scales=(1, 1e3, 1), count="= 401", changes=()):
    """A text export; `changes` are cells by row and column."""
    rows = [[f"{value * scale:.6f}" for value, scale in zip(row, scales, strict=True)] for row in _rows(headings)]
    for row, column, cell in changes:
        rows[row][column] = cell
    return "\n".join(["Mon Apr 29", "", f"Number of Points {count}", headings, *map("\t".join, rows), ""])


def _rows(headings):
    channels = {"Depth": DEPTH, "Load": LOAD, "Time": TIME, "Disp.": 3 - (DEPTH + 2 * LOAD + 0.5 * TIME) / 900}
    return np.column_stack([channels[heading.split()[0]] for heading in headings.split("\t")])


def read(tmp_path, content, encoding="latin-1", **options):
    file = tmp_path / "x.txt"
    file.write_bytes(content.encode(encoding))
    (test,) = read_vendor_file(file, **options)
    return test


def test_the_first_point_is_the_last_without_load(tmp_path):
    recording = read(tmp_path, text()).recording
    assert (len(recording), recording.time[0], recording.load[0]) == (301, 0, pytest.approx(-0.002))
    assert recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100])


def test_the_sensor_s_volts_under_an_older_heading_give_the_raw_depth(tmp_path):
    content = text("Depth (nm)\tLoad (µN)\tTime (s)\tDisp. Voltage(V)", (1, 1e3, 1, 1))
    (own, raw) = (read(tmp_path, content, corrections=chosen) for chosen in (None, RAW))
    assert float(raw.metadata["frame compliance [nm/mN]"]) == pytest.approx(2.0, abs=0.01)
    assert float(raw.metadata["drift [nm/s]"]) == pytest.approx(0.5, abs=0.01)
    taken_off = 2 * (LOAD[100:] - LOAD[100]) + 0.5 * (TIME[100:] - TIME[100])
    assert raw.recording.depth - own.recording.depth == pytest.approx(taken_off, abs=0.05)


def test_blank_lines_between_segments_are_no_points(tmp_path):
    """As the TI Premier writes them."""
    lines = text().split("\n")
    apart = "\n".join([*lines[:5], "", *lines[5:150], "", *lines[150:]])
    assert np.array_equal(read(tmp_path, apart).recording.depth, read(tmp_path, text()).recording.depth)


@pytest.mark.parametrize("cell", ["", "nan", "inf", "1.79769e308"])
@pytest.mark.parametrize("column", [0, 1, 2])
def test_a_cell_without_a_number_costs_its_row_and_is_named(tmp_path, column, cell):
    test = read(tmp_path, text(changes=[(250, column, cell)]))
    assert test.warnings[0] == "1 of 401 points left out: no number (point 251)"
    assert test.recording.depth == pytest.approx(np.delete(DEPTH, 250)[100:] - DEPTH[100])


def test_a_blank_first_row_is_no_damage(tmp_path):
    assert len(read(tmp_path, text(changes=[(0, 1, "")])).recording) == 301


@pytest.mark.parametrize(
    ("headings", "scales", "encoding"),
    [
        ("Depth (nm)\tLoad (μN)\tTime (s)", (1, 1e3, 1), "utf-8"),
        ("Depth (nm)\tLoad (µN)\tTime (s)", (1, 1e3, 1), "utf-16"),
        ("Depth (nm)\tLoad (uN)\tTime (s) ", (1, 1e3, 1), "utf-8"),
        ("Depth (um)\tLoad (mN) \tTime (ms)", (1e-3, 1, 1e3), "utf-8"),
        ("Time (s)\tDepth (nm)\tLoad (µN)", (1, 1, 1e3), "utf-8-sig"),
    ],
)
@pytest.mark.parametrize("count", ["= 401", "=401", ": 401"])
def test_headings_are_understood_as_written(tmp_path, headings, scales, encoding, count):
    recording = read(tmp_path, text(headings, scales, count), encoding).recording
    assert recording.load == pytest.approx(LOAD[100:], abs=1e-5)
    assert recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100], abs=1e-2)
    assert recording.time == pytest.approx(TIME[100:] - 5, abs=1e-5)


def test_a_count_may_part_its_thousands(tmp_path):
    rows = "".join(f"{k}\t{k}\t{k}\n" for k in range(1200))
    head = "Mon\n\nNumber of Points = 1,200\nDepth (nm)\tLoad (uN)\tTime (s)\n"
    assert len(read(tmp_path, head + rows).recording) == 1200
    with pytest.raises(InputError, match="announces 'many' points"):
        read(tmp_path, (head + rows).replace("1,200", "many"))


@pytest.mark.parametrize("peaks", [(0.2, 0.5, 0.9, 5, 10), (2, 5, 10)])
@pytest.mark.parametrize("offset", [-0.3, 0.0, 0.03])
def test_contact_is_before_the_first_of_many_cycles(peaks, offset):
    times, loads = [0.0, 5.0], [0.0, 0.0]
    for peak in peaks:
        times += [times[-1] + step for step in (5, 7, 12, 14)]
        loads += [peak, peak, 0, 0]
    time = np.arange(0, times[-1], 0.1)
    force = np.interp(time, times, loads)
    load = force + 0.002 * np.random.default_rng(0).standard_normal(len(time)) + offset
    assert 4 <= time[contact(load, 100 * np.sqrt(force))] <= 6


def test_load_left_from_the_search_for_the_surface_is_passed_over():
    time = np.arange(0, 40, 0.1)
    force = np.interp(time, [0, 1, 10, 40], [0.3, 0, 0, 10])
    assert time[contact(force, 100 * np.sqrt(force))] == pytest.approx(10)


def lifted(rng, noise, offset, points, before):
    """Load, depth and the last point without load: to 100 mN by Hertz's law, after a preload and a lift or a way in.

    Before contact the tip rests at 1 mN and is lifted by 1000 nm ("lift"), comes from there ("way"), or the file begins
    at contact ("none") or under 2 mN ("loaded").
    """
    force = np.linspace(0.0 if before != "loaded" else 2.0, 100.0, 2000)
    way = {
        "lift": np.append(np.linspace(40, -960, points), np.linspace(-960, 0, points)),
        "way": np.linspace(-960, 0, points),
    }
    depth = np.append(way.get(before, []), 860 * (force / 100) ** (2 / 3))
    load = 100 * (np.clip(depth, 0, None) / 860) ** 1.5 + offset + noise * rng.standard_normal(len(depth))
    return load, depth + 0.15 * rng.standard_normal(len(depth)), max(len(depth) - len(force), 0)


@pytest.mark.parametrize("before", ["lift", "way"])
@pytest.mark.parametrize("points", [100, 4000])
@pytest.mark.parametrize("noise", [0.0, 0.001, 0.03])
@pytest.mark.parametrize("offset", [-0.5, -0.03, 0.0, 0.03, 0.15, 0.5])
def test_contact_is_found_whatever_the_load_reads_without_it(before, points, noise, offset):
    for seed in range(4):
        load, depth, truth = lifted(np.random.default_rng(seed), noise, offset, points, before)
        begin = contact(load, depth)
        assert -12 <= begin - truth <= 5
        assert depth[begin] - depth[truth] < 9


@pytest.mark.parametrize("before", ["none", "loaded"])
@pytest.mark.parametrize("noise", [0.0, 0.001, 0.03])
@pytest.mark.parametrize("offset", [0.0, 0.15, 0.5])
def test_the_start_of_a_file_that_begins_under_a_rising_load_is_kept(before, noise, offset):
    for seed in range(4):
        load, depth, _ = lifted(np.random.default_rng(seed), noise, offset, 1, before)
        assert contact(load, depth) <= 4


@pytest.mark.parametrize(("offset", "words"), [(0.302, ["the load reads 0.3 mN before contact"]), (0.001, [])])
def test_a_load_that_is_not_zero_before_contact_is_told(tmp_path, monkeypatch, offset, words):
    monkeypatch.setitem(globals(), "LOAD", LOAD + offset)
    test = read(tmp_path, text())
    assert test.recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100])
    said = [warning.partition(" (")[0] for warning in test.warnings]
    assert said.pop(0) == "the depth is counted from where the test begins, 10 nm of the file"
    assert said == words


@pytest.mark.parametrize("written", ["{:,.4f}", "{:,.3f}", "{:.3f}"])
@pytest.mark.parametrize("comma", [False, True])
def test_a_sign_that_parts_thousands_is_no_decimal_sign(tmp_path, written, comma):
    """As in 1,001.9436 and 1.001,9436; loads in uN."""
    lines = text().splitlines()
    body = ["\t".join(written.format(float(cell)) for cell in line.split("\t")) for line in lines[4:]]
    swapped = [line.translate(str.maketrans(",.", ".,")) if comma else line for line in body]
    recording = read(tmp_path, "\n".join([*lines[:4], *swapped])).recording
    assert recording.load == pytest.approx(LOAD[100:], abs=1e-6)
    assert recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100], abs=1e-3)


@pytest.mark.parametrize(("cell", "load"), [("1,200", 1.2), ("5,304.5", 5.3045)])
def test_one_load_with_a_comma_among_points_is_in_thousands(tmp_path, cell, load):
    recording = read(tmp_path, text(changes=[(250, 1, cell)])).recording
    assert recording.load[150] == pytest.approx(load)


def test_a_comma_that_may_be_either_is_refused(tmp_path):
    rows = "0\t0\t0\n100\t1,200\t1\n50\t0\t2\n"
    with pytest.raises(InputError, match="line 6: '1,200' has a decimal sign or parts thousands"):
        read(tmp_path, "Mon\n\nNumber of Points = 3\nDepth (nm)\tLoad (uN)\tTime (s)\n" + rows)


HEADER = {
    "File Version": "Hysitron", "Machine Comp": "0.004 nm/µN", "Drift Rate": "0.2 nm/s", "Disp Shift": "-10 nm",
    "Force Shift": "-50 µN", "Test Data Points": "401",
}  # fmt: skip


def hld(**changes):
    """A .hld file, in which blanks of the header's names are written as underscores."""
    header = HEADER | {name.replace("_", " "): value for name, value in changes.items()}
    rows = np.column_stack([TIME, DEPTH - 10, 1e3 * LOAD - 50, 0 * TIME])
    lines = [f"{key}: {value}" for key, value in header.items()]
    return "\n".join(
        [*lines, "Time_s\tDisp_nm\tForce_µN\tLoadCell_nm", *("\t".join(f"{v:.6f}" for v in r) for r in rows)]
    )


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-16"])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"Machine_Comp": "0,004 nm/µN", "Drift_Rate": "0,2 nm/s"},
        {"Machine_Comp": "4 nm/mN", "Force_Shift": "-0.05 mN", "Disp_Shift": "-0.01 um"},
        {"Drift_Rate": "12 nm/min", "Force_Shift": "-50 μN"},
    ],
)
def test_a_header_s_decimal_comma_and_units_are_heeded(tmp_path, changes, encoding):
    if encoding == "latin-1":
        changes = {key: value.replace("μ", "u") for key, value in changes.items()}
    vendor, raw = (read(tmp_path, hld(**changes), encoding, corrections=chosen).recording for chosen in (None, RAW))
    assert vendor.depth == pytest.approx(DEPTH[100:], abs=1e-5)
    assert raw.depth - vendor.depth == pytest.approx(0.2 * raw.time + 4 * (raw.load - raw.load[0]), abs=1e-5)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (hld(Test_Data_Points="about 401"), "announces 'about 401' points"),
        (hld(Disp_Shift="error"), "Disp Shift: is 'error', expected a number and its unit"),
        (hld(Disp_Shift="---"), "Disp Shift: is '---'"),
        (hld(Force_Shift="-50"), "Force Shift: is '-50'"),
        (hld(Force_Shift="-50 klb"), "Force Shift: is '-50 klb'"),
        (hld().partition("\nTime_s")[0], "lacks the column Time, Disp, Force, LoadCell"),
    ],
)
def test_a_spoilt_hld_gets_one_line(tmp_path, content, words, capsys):
    (tmp_path / "x.hld").write_text(content, encoding="utf-8")
    assert main(["read", str(tmp_path / "x.hld"), "-o", str(tmp_path)]) == 2
    line = capsys.readouterr().err.strip()
    assert words in line
    assert "\n" not in line


def test_a_correction_that_the_header_does_not_state_is_missed_only_when_it_is_asked_for(tmp_path):
    assert len(read(tmp_path, hld(Drift_Rate="n/a")).recording) == 301
    with pytest.raises(InputError, match="Drift Rate: is 'n/a'"):
        read(tmp_path, hld(Drift_Rate="n/a"), corrections=RAW)


AREA = {"Tip C0": "24.5 nm^2/nm^2", "Tip C1": "5000 nm^2/nm", "Tip C2": "0 nm^2/nm^0.5", "Tip B": "0 nm"}


def newer(force="Force_µN", disp="Disp_nm", scales=(1.0, 1e3), offset=0.0):
    """A .hld file without a version, whose compliance is 4 nm/mN and whose drift is 0.2 nm/s."""
    cell = 3500 - 20 * LOAD
    sensor = DEPTH - cell + 4 * LOAD + 0.2 * TIME - 77
    rows = np.column_stack([TIME, scales[0] * DEPTH, scales[1] * (LOAD + offset), cell, sensor])
    header = {"Test Type": "Indentation", "Time Stamp": "Wed Mar 06 10:00:00 2024"} | AREA | {"Test Data Points": "401"}
    lines = [f"{key}: {value}" for key, value in header.items()]
    body = ["\t".join(f"{value:.6f}" for value in row) for row in rows]
    return "\n".join([*lines, f"Time_s\t{disp}\t{force}\tLoadCell_nm\tPiezoDisp_nm", *body])


@pytest.mark.parametrize("offset", [0.0, 0.03, -0.5])
@pytest.mark.parametrize(
    ("force", "disp", "scales"),
    [("Force_uN", "Disp_nm", (1, 1e3)), ("Force_µN", "Disp_nm", (1, 1e3)), ("Force_mN", "Disp_um", (1e-3, 1))],
)
def test_a_newer_hld_without_a_version_is_read(tmp_path, force, disp, scales, offset):
    """Contact is at 5 s, where depth and load are counted from; the tip's area function is among the facts."""
    test = read(tmp_path, newer(force, disp, scales, offset), "utf-8")
    assert test.recording.time == pytest.approx(TIME[100:] - 5)
    assert test.recording.load == pytest.approx(LOAD[100:] - LOAD[100], abs=1e-5)
    assert test.recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100], abs=2e-3)
    assert any("the file marks no contact" in warning for warning in test.warnings)
    assert coefficients(test.metadata) == (24.5, 5000.0)


def test_a_newer_hld_s_frame_and_drift_follow_from_the_sensor_s_displacement(tmp_path):
    vendor, raw = (read(tmp_path, newer(), corrections=chosen) for chosen in (None, RAW))
    assert float(raw.metadata["frame compliance [nm/mN]"]) == pytest.approx(4.0, abs=1e-4)
    assert float(raw.metadata["drift [nm/s]"]) == pytest.approx(0.2, abs=1e-4)
    taken_off = 0.2 * raw.recording.time + (4 + 20) * raw.recording.load
    assert raw.recording.depth - vendor.recording.depth == pytest.approx(taken_off, abs=1e-3)
    with pytest.raises(InputError, match=r"states neither compliance nor drift rate.*leave --raw and --correct off"):
        read(tmp_path, newer().replace("PiezoDisp", "Elsewhere"), corrections=RAW)


def test_without_a_column_of_the_load_cell_the_frame_stands_for_it(tmp_path):
    vendor, raw = (read(tmp_path, newer().replace("LoadCell", "Other"), corrections=chosen) for chosen in (None, RAW))
    assert vendor.recording.depth == pytest.approx(DEPTH[100:] - DEPTH[100], abs=2e-3)
    assert float(raw.metadata["frame compliance [nm/mN]"]) == pytest.approx(4.0 + 20.0, abs=1e-3)


@pytest.mark.parametrize(("spoil", "words"), [
    (lambda text: text.replace("Disp_nm", "Disp_V", 1), "of no format that palpate knows"),
    (lambda text: text[:-500], "were announced; the file is cut off"),
])  # fmt: skip
def test_a_spoilt_newer_hld_gets_one_line(tmp_path, spoil, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, spoil(newer()))


@pytest.mark.parametrize(
    "above",
    [
        "Tue Nov 22\n\nNumber of Points = {}\nDepth (nm)\tLoad (µN)\tTime (s)",
        "Test Type: Indentation\nTest Data Points: {}\nDisp_nm\tForce_µN\tTime_s",
    ],
    ids=["text", "hld without a version"],
)
def test_contact_after_a_retreat_is_found_where_the_transducer_s_spring_pulls(tmp_path, above):
    """A TI Premier lifts the tip from its first touch; without contact the load falls with the depth."""
    time = np.linspace(0.0, 24.0, 2401)
    load = np.interp(time, [0.0, 0.5, 2.0, 2.2, 12.0, 14.0, 24.0], [0.0, -4e-3, -5.2e-3, -4.4e-3, 5.0, 5.0, 0.0])
    touched = np.maximum(load + 4.4e-3, 0.0)
    air = np.interp(time, [0.0, 0.5, 2.0, 2.2], [0.0, -2.0, -32.0, -8.0])
    depth = np.where(time < 2.2, air, -8.0 + 110 * np.sqrt(touched))
    rows = zip(depth, 1e3 * load, time, strict=True)
    lines = [above.format(len(time)), *("\t".join(f"{value:.6f}" for value in row) for row in rows), ""]
    test = read(tmp_path, "\n".join(lines))
    peak = int(np.argmax(test.recording.load))
    assert test.recording.depth[peak] == pytest.approx(110 * np.sqrt(5.0), rel=0.01)
    assert (test.recording.load[0], test.recording.depth[0]) == (0.0, 0.0)
    assert any("the tip retreats by 32 nm before contact" in message for message in test.warnings)
