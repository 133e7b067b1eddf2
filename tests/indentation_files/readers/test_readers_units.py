"""Units of a table's columns: as it states them, as the user does, or the usual ones with a word."""

import re

import pytest
from tables import FORCE, NUMBERED, PATH, TIME

from indentation_files.readers import ColumnMap, read_vendor_file
from palpate.errors import InputError


@pytest.mark.parametrize(
    ("headings", "below"),
    [
        (("Time (s)", "Load (µN)", "Depth (µm)"), []),
        (("t / s", "P / uN", "h / um"), []),
        (("time_s", "load_uN", "depth_um"), []),
        (("t", "F_N", "h"), ["s\tµN\t[μm]"]),
        (("t", "F_N", "h"), ["raw\traw\traw", "s\tµN\t[μm]"]),
        (("elapsed_time_s", "sample_load_uN", "tip_depth_um_raw"), []),
        (("time_s", "load_micro_N", "depth_micro_m"), []),
        (("Time s", "Load in uN", "Depth, um"), []),
        (("s", "uN", "um"), []),
        (("Time (s)", "Load / uN", "Depth_um"), ["sec\tμN\tum"]),
        (("t<s>", "F.uN", "h{um}"), []),
        (("t:s", "load-uN", "Depth (raw) / um"), []),
        (("Time (Sec)", "LOAD [UN]", "DEPTH (UM)"), []),
        (("Sampling time [sec.]", "Load, µN", "Depth【µm】"), []),
        (("Time, s", "micronewtons", "Depth (microns)"), []),
        (("Time / secs.", "Load (Micronewton)", "Depth, corrected (micrometre)"), []),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_units_that_the_table_states_are_used(tmp_path, headings, below, encoding):
    file = tmp_path / "x.txt"
    rows = [f"{a:g}\t{b:.6f}\t{c:.6f}" for a, b, c in zip(TIME, FORCE, PATH, strict=True)]
    file.write_text("\n".join(["\t".join(headings), *below, *rows]), encoding=encoding)
    names = dict(zip(("time", "load", "depth"), headings, strict=True))
    for called, given, load_unit, turn in (
        (names, {}, "uN", 1e-3), (names, {"load": "-N"}, "-N", -1e3), (NUMBERED.names, {}, "uN", 1e-3)
    ):  # fmt: skip
        (test,) = read_vendor_file(file, columns=ColumnMap(called, given), contact="none")
        assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-2)
        assert test.recording.load == pytest.approx(turn * FORCE, abs=1e-2 * abs(turn))
        assert f"[{load_unit}]" in test.metadata["columns"]


UNKNOWN = [
    "P / klbf",
    "P_mlbf",
    "P nm",
    "LOAD_MN",
    "LOAD (MN)",
    "Load grams",
    "P (1e-3 N)",
    "P 10^-3 [N]",
    "P 10⁻³ (N)",
    "P 1e-3 (N)",
    "P [N] x1000",
    "P [N] (x 1000)",
]


@pytest.mark.parametrize(
    ("unit", "newton"),
    [
        ("gf", 9.80665e-3),
        ("g-force", 9.80665e-3),
        ("kgf", 9.80665),
        ("lbf", 4.4482216152605),
        ("dyne", 1e-5),
        ("dyn", 1e-5),
        ("cN", 0.01),
        ("daN", 10.0),
        ("kN", 1e3),
        ("lb", 4.4482216152605),
    ],
)
def test_loads_in_other_systems_of_units(tmp_path, unit, newton):
    """Against Newtons by the definitions of the standard gravity, the pound and the dyne."""
    file = tmp_path / "x.txt"
    file.write_text(f"Time (s)\tLoad ({unit})\tDepth (nm)\n0\t0\t0\n1\t2\t3\n")
    for given in ({}, {"load": unit}):
        (test,) = read_vendor_file(file, columns=ColumnMap(NUMBERED.names, given))
        assert test.recording.load.max() == pytest.approx(2e3 * newton)


@pytest.mark.parametrize("heading", UNKNOWN)
@pytest.mark.parametrize("by_name", [True, False])
def test_a_stated_unit_that_is_not_known_is_refused(tmp_path, heading, by_name):
    file = tmp_path / "x.csv"
    file.write_text(f"t,{heading},h\n0,0,0\n1,1,1\n")
    names = {"time": "t", "load": heading, "depth": "h"} if by_name else NUMBERED.names
    column = re.escape(names["load"])
    with pytest.raises(InputError, match=f"x.csv, column {column}: the load's unit '.+' is not known.*mN, uN"):
        read_vendor_file(file, columns=ColumnMap(names))
    (test,) = read_vendor_file(file, columns=ColumnMap(names, {"load": "N"}))
    assert test.recording.load.max() == 1000


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["t,F_N,h"], "column F_N: 'N' may be the load's unit or part of the name"),
        (["t,F_N,h", "s,klb,nm"], "the load's unit 'klb' is not known"),
        (["s,klb,nm", "t,F_N,h"], "the load's unit 'klb' is not known"),
        (["t,F_N,h", "s,mN,nm", "s,uN,nm"], "the load's unit is stated as mN and uN"),
    ],
)
def test_a_unit_that_cannot_be_told_is_refused(tmp_path, rows, words):
    file = tmp_path / "x.csv"
    file.write_text("\n".join([*rows, "0,0,0", "1,1,1"]))
    for names in ({"time": "t", "load": "F_N", "depth": "h"}, NUMBERED.names):
        with pytest.raises(InputError, match=words.replace("F_N:", f"{names['load']}:")):
            read_vendor_file(file, columns=ColumnMap(names))


@pytest.mark.parametrize("above", [["Time\tLoad\tDepth", "s\tN\tum"], ["s\tN\tum", "Time\tLoad\tDepth"], ["s\tN\tum"]])
def test_a_row_of_units_is_found_wherever_it_stands(tmp_path, above):
    file = tmp_path / "x.txt"
    file.write_text("\n".join(["Sample (glass)\tA/B", *above, "0\t0\t0", "1\t2\t3"]))
    for names in ({"time": "Time", "load": "Load", "depth": "Depth"}, NUMBERED.names):
        if names is NUMBERED.names or len(above) > 1:
            (test,) = read_vendor_file(file, columns=ColumnMap(names))
            assert (test.recording.load.max(), test.recording.depth.max()) == (2000, 3000)


@pytest.mark.parametrize(
    ("time", "load", "depth"),
    [
        ("Time", "Load", "Depth"),
        ("t", "P", "h"),
        ("Time on sample", "Load On Sample", "Displacement Into Surface"),
        ("Zeit", "Normal force Fn", "Penetration depth Pd"),
        ("time_raw", "Raw Load", "Depth corrected"),
        ("Elapsed Time", "Force 1", "hc (nm)"),
        ("TIME", "P_max_300mN", "h_s"),
        ("A", "B", "C"),
    ],
)
def test_headings_without_a_unit_leave_the_usual_ones(tmp_path, time, load, depth):
    file = tmp_path / "x.csv"
    file.write_text(f"{time},{load},{depth}\nnan,nan,nan\n0,0,0\n1,2,3\n")
    for names in ({"time": time, "load": load, "depth": depth}, NUMBERED.names):
        (test,) = read_vendor_file(file, columns=ColumnMap(names))
        assert (test.recording.time[-1], test.recording.load.max(), test.recording.depth.max()) == (1, 2, 3)


def test_units_that_nobody_states_are_told(tmp_path):
    file = tmp_path / "x.csv"
    file.write_text("Time (s),Load,Depth\n0,0,0\n1,1,1\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.warnings == ("no unit is stated: load taken as mN, depth taken as nm (--units)",)
    (test,) = read_vendor_file(file, columns=ColumnMap(NUMBERED.names, {"load": "uN", "depth": "um"}))
    assert test.warnings == ()
    assert test.recording.load[-1] == pytest.approx(1e-3)


@pytest.mark.parametrize("name", ["Displacement [um]", "Displacement [µm]", "Displacement [μm]"])
def test_columns_are_found_by_whatever_micro_sign(tmp_path, name):
    file = tmp_path / "x.csv"
    file.write_text("Time [s],Load [mN],Displacement [µm]\n0,0,0\n1,1,2\n", encoding="utf-8")
    (test,) = read_vendor_file(file, columns=ColumnMap({"time": "Time [s]", "load": "Load [mN]", "depth": name}))
    assert test.recording.depth == pytest.approx([0, 2000])


@pytest.mark.parametrize(
    ("encoding", "micro"),
    [("gbk", "μ"), ("shift_jis", "μ"), ("big5", "μ"), ("euc-kr", "μ"), ("utf-8", "Âµ"), ("cp1252", "µ")],
)
@pytest.mark.parametrize("wide", [True, False])
def test_a_micro_sign_is_one_in_whatever_encoding_it_was_written(tmp_path, encoding, micro, wide):
    file = tmp_path / "x.txt"
    rows = [f"{a:g}\t{b:.6f}\t{c:.6f}" for a, b, c in zip(TIME, FORCE, PATH, strict=True)]
    head = f"t (s)\tP ({micro}N)\th ({micro}m)"
    if wide and encoding != "cp1252":
        head = head.replace("(", "（").replace(")", "）")
    file.write_bytes("\n".join([head, *rows]).encode(encoding))
    (test,) = read_vendor_file(file, columns=ColumnMap(NUMBERED.names, {}), contact="none")
    assert test.recording.load == pytest.approx(1e-3 * FORCE, abs=1e-5)
    assert test.recording.depth == pytest.approx(1e3 * PATH, abs=1e-2)


@pytest.mark.parametrize(
    ("units", "factors"),
    [
        (("msec", "mgf", "A"), (1e-3, 9.80665e-3, 0.1)),
        (("Min.", "gf", "Angstroms"), (60, 9.80665, 0.1)),
        (("minutes", "kgf", "MM"), (60, 9806.65, 1e6)),
        (("hrs", "Grams-Force", "cm"), (3600, 9.80665, 1e7)),
        (("us", "nanonewtons", "pm"), (1e-6, 1e-6, 1e-3)),
        (("S", "pN", "NM"), (1, 1e-9, 1)),
        (("Sekunden", "Mikronewton", "Mikrometer"), (1, 1e-3, 1e3)),
        (("secondes", "millinewtons", "micromètres"), (1, 1, 1e3)),
        (("days", "mN", "Ang."), (86400, 1, 0.1)),
    ],
)
@pytest.mark.parametrize("brackets", ["{} ({})", "{} [{}]", "{}<{}>", "{} / {}", "{}, {}"])
def test_units_in_every_spelling_of_the_field(tmp_path, units, factors, brackets):
    """Factors by the definitions of the units; a gram-force is 9.80665 mN (standard gravity)."""
    file = tmp_path / "x.txt"
    head = "\t".join(brackets.format(name, unit) for name, unit in zip(("Time", "Load", "Depth"), units, strict=True))
    file.write_text(f"{head}\n0\t0\t0\n1\t1\t1\n2\t2\t2\n")
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.warnings == ()
    recording = test.recording
    assert (recording.time[1], recording.load[1], recording.depth[1]) == pytest.approx(factors)
