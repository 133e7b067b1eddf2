"""Binary files: force curves by afmformats, Fischer's HDF5 by h5py, and containers that no reader knows."""

import sys
import zipfile

import numpy as np
import pytest
from public_files import RECORDINGS, needs_recordings

from indentation_files.readers import ColumnMap, read_each, read_vendor_file
from indentation_files.readers.igor import is_wave, sampling
from palpate.cli.main import main
from palpate.errors import InputError

TIME = np.linspace(0, 60, 241)
LOAD = np.interp(TIME, [0, 20, 40, 60], [0, 10, 10, 0])
DEPTH = 0.3 * np.sqrt(LOAD) + 0.002 * TIME  # um


def test_afm_force_curve(tmp_path):
    """Hertz under a soft cantilever: the tip's depth is the piezo's travel less the deflection."""
    afmformats = pytest.importorskip("afmformats")
    time = np.linspace(0, 2, 1001)
    depth = 400.0 - 1000.0 * np.abs(time - 1)
    force = 1e-9 * 2e-3 * np.clip(depth, 0, None) ** 1.5 + 2e-12 * np.sin(np.arange(1001) ** 2)
    data = {"time": time, "force": force, "height (measured)": 1e-6 - 1e-9 * depth - force / 0.05,
            "segment": (time > 1).astype(np.uint8)}  # fmt: skip
    facts = {"spring constant": 0.05, "sensitivity": 5e-8, "path": tmp_path / "x", "enum": 0,
             "imaging mode": "force-distance", "feedback mode": "contact"}  # fmt: skip
    curve = afmformats.AFMForceDistance(data=data, metadata=afmformats.meta.MetaData(facts))
    curve.export_data(tmp_path / "x.h5", fmt="hdf5")
    file = tmp_path / "named_otherwise.dat"
    file.write_bytes((tmp_path / "x.h5").read_bytes())
    (whole,), (test,) = (read_vendor_file(file, contact=choice) for choice in ("none", "auto"))
    assert whole.recording.depth == pytest.approx(depth - depth[0], abs=1e-3)
    assert test.recording.load.max() == pytest.approx(1.6e-5, rel=0.01)
    assert test.recording.depth.max() == pytest.approx(400, abs=5)
    file.write_bytes(file.read_bytes()[:3000])
    with pytest.raises(InputError, match="afmformats cannot read it"):
        read_vendor_file(file)


def test_afm_without_its_library_gets_one_line(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "afmformats", None)
    with zipfile.ZipFile(tmp_path / "a.jpk-force", "w") as archive:
        archive.writestr("header.properties", "type=x")
    with pytest.raises(InputError, match="pip install afmformats"):
        read_vendor_file(tmp_path / "a.jpk-force")


@needs_recordings
@pytest.mark.parametrize(("name", "points"), [("SiN_FD_plot", 2016), ("U3_3_p10004", 10097)])
def test_an_igor_wave_agrees_with_its_own_note(name, points):
    """The load reaches the trigger point; approach and retract take as long as the note's distance and velocity say."""
    pytest.importorskip("afmformats")
    (whole,) = read_vendor_file(RECORDINGS / f"afmformats/fmt-igor-fd_{name}.ibw", contact="none")
    facts, r = whole.metadata, whole.recording
    assert whole.warnings == ()
    assert len(r) == points
    free = float(np.median(r.load[: points // 10]))
    assert 1e-3 * (r.load.max() - free) == pytest.approx(float(facts["setpoint"]), rel=0.03)
    assert r.time[-1] == pytest.approx((points - 1) / float(facts["rate approach"]))
    note = (RECORDINGS / f"afmformats/fmt-igor-fd_{name}.ibw").read_bytes()
    distance, velocity = (float(note.split(b"\r" + key)[1].split(b"\r")[0]) for key in (b"ForceDist:", b"Velocity:"))
    assert r.time[int(np.argmax(r.load))] == pytest.approx(distance / velocity, rel=0.02)


@needs_recordings
def test_scaling_and_rate_of_an_igor_wave_that_differ_are_told():
    pytest.importorskip("igor2")
    content = (RECORDINGS / "afmformats/fmt-igor-fd_U3_3_p10004.ibw").read_bytes()
    assert sampling(content) == (pytest.approx(5e-4), ())
    step, told = sampling(content.replace(b"NumPtsPerSec: 2000", b"NumPtsPerSec: 1000"))
    assert step == pytest.approx(5e-4)
    assert told == ("the wave's scaling says 0.0005 s between points, its NumPtsPerSec 0.001 s; the former is taken",)
    assert sampling(content.replace(b"NumPtsPerSec", b"NumPtsPerXXX")) == (pytest.approx(5e-4), ())


@pytest.mark.parametrize("begin", [b"\x05\x00", b"\x00\x05", b"\x02\x00"])
def test_an_igor_wave_without_spring_constant_or_sensitivity_is_told(tmp_path, begin):
    file = tmp_path / "x.ibw"
    for note, lacks in (
        (b"InvOLS: 5e-8\r", "spring constant"),
        (b"ThermalSpringConstant: 3\rSpringConstant: NaN\rInvOLS: 5e-8\r", "spring constant"),
        (b"SpringConstant: 0.3\rInvOLS: 0\r", r"sensitivity \(InvOLS\)"),
        (b"", r"spring constant and no sensitivity \(InvOLS\)"),
    ):
        file.write_bytes(begin + bytes(400) + note + b"NumPtsPerSec: 2000\r")
        with pytest.raises(InputError, match=f"states no {lacks}, so that its deflection is no load; calibrate"):
            read_vendor_file(file)
    assert not is_wave(begin + bytes(400) + b"an image")


@needs_recordings
@pytest.mark.parametrize("name", ["SiN_FD_plot", "U3_3_p10004"])
def test_an_igor_wave_that_is_cut_off_is_called_one(tmp_path, name):
    """Its note comes last."""
    content = (RECORDINGS / f"afmformats/fmt-igor-fd_{name}.ibw").read_bytes()
    (tmp_path / "x.ibw").write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match="palpate knows: an Igor wave that is cut off, or has no note on a cantilever"):
        read_vendor_file(tmp_path / "x.ibw")


def test_a_jpk_curve_without_a_spring_constant_is_told(tmp_path, monkeypatch, capfd):
    afmformats = pytest.importorskip("afmformats")

    def fail(path):
        raise afmformats.errors.MissingMetaDataError(["spring constant", "sensitivity"])

    monkeypatch.setattr(afmformats, "load_data", fail)
    with zipfile.ZipFile(tmp_path / "a.jpk-force", "w") as archive:
        archive.writestr("header.properties", "type=x")
    with pytest.raises(InputError, match="states no spring constant and no sensitivity, so that its deflection is no"):
        read_vendor_file(tmp_path / "a.jpk-force")
    assert capfd.readouterr() == ("", "")


def fischer(path, units=("s", "mN", "um"), tests=({},), uri="https://x/hap2hdf.py", folder="test_{}/data"):
    """Write Fischer's HDF5 as the converter does."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file.attrs["uri"], file.attrs["version"] = uri.encode(), b"2.0"
        file.create_group("instrument").attrs["max_load"] = np.array([10.0])
        for number, changed in enumerate(tests, 1):
            group = file.create_group(folder.format(number))
            channels = {"force": LOAD, "displacement": DEPTH, "time": TIME} | changed
            for (name, values), unit in zip(channels.items(), (units[1], units[2], units[0]), strict=True):
                group.create_dataset(name, data=values)
                if unit:
                    group[name].attrs["unit"] = unit
    return path


def test_air_in_fischer_s_hdf5_is_left_out(tmp_path):
    """Its clock and its depth count from where the tip sets out."""
    time, load = np.append(TIME, TIME[-1] + TIME[1:]), np.append(0 * TIME, LOAD[1:])
    depth = np.append(1.5 * TIME / 60, 1.5 + DEPTH[1:])
    changed = {"time": time, "force": load + 1e-4 * np.sin(np.arange(len(load)) ** 2), "displacement": depth}
    (test,) = read_vendor_file(fischer(tmp_path / "x.hdf5", tests=(changed,)))
    assert test.warnings[0].startswith("the file marks no contact")
    assert test.recording.depth.max() == pytest.approx(1e3 * DEPTH.max(), rel=0.02)


@pytest.mark.parametrize("units", [("s", "mN", "um"), ("s", "mN", "µm"), ("s", b"mN", b"um")])
@pytest.mark.parametrize("folder", ["test_{}/data", "Test {}"])
def test_fischer_s_hdf5_is_read_with_its_units(tmp_path, units, folder):
    tests = read_vendor_file(fischer(tmp_path / "x.hdf5", units, ({}, {"force": 2 * LOAD}), folder=folder))
    assert [test.name for test in tests] == [folder.format(k).removesuffix("/data") for k in (1, 2)]
    assert tests[0].recording.time == pytest.approx(TIME)
    assert tests[0].recording.depth == pytest.approx(1e3 * DEPTH)
    assert tests[1].recording.load == pytest.approx(2 * LOAD)
    assert tests[0].metadata["max_load"] == "10.0"


def test_what_fischer_s_clock_begins_anew_after_is_the_search_for_the_surface(tmp_path):
    """A search without load, then the test whose clock begins anew at the end of loading too."""
    search = np.arange(20) * 0.25
    time = np.concatenate([search, TIME[:80], TIME[80:] - TIME[80]])
    load, depth = (np.concatenate([0 * search, channel]) for channel in (LOAD, DEPTH))
    channels = {"force": load, "displacement": depth, "time": time}
    (test,) = read_vendor_file(fischer(tmp_path / "x.hdf5", tests=(channels,)))
    assert test.recording.time == pytest.approx(TIME)
    assert test.recording.load == pytest.approx(LOAD)
    assert any("without load before the clock begins anew" in warning for warning in test.warnings)
    assert any("joined as segments" in warning for warning in test.warnings)


@pytest.mark.parametrize(
    ("units", "changed", "words"),
    [
        (("s", "mN", ""), {}, "states no unit of its displacement; convert it again with one of: nm, um"),
        (("s", "V", "um"), {}, "its force is in 'V'; convert it again with one of: mN"),
        (("s", "mN", "um"), {"time": TIME[:50]}, "its channels are of unequal length"),
    ],
)
def test_a_spoilt_test_of_fischer_s_hdf5_costs_only_itself(tmp_path, units, changed, words):
    with pytest.raises(InputError, match=words):
        read_vendor_file(fischer(tmp_path / "x.hdf5", units, (changed,)))
    if changed:
        assert len(read_each(fischer(tmp_path / "x.hdf5", units, ({}, changed)))) == 2


def test_fischer_s_hdf5_without_its_library_gets_one_line(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    (tmp_path / "x.hdf5").write_bytes(b"\x89HDF\r\n\x1a\n" + b"hap2hdf.py" + bytes(50))
    with pytest.raises(InputError, match="Fischer's HDF5 needs the library h5py; install it: pip install h5py"):
        read_vendor_file(tmp_path / "x.hdf5")


def test_a_cut_hdf5_of_fischer_s_gets_one_line(tmp_path):
    file = fischer(tmp_path / "x.hdf5")
    file.write_bytes(file.read_bytes()[:2000] + b"hap2hdf")
    with pytest.raises(InputError, match=r"h5py cannot read it \(OSError\); copy or export it again"):
        read_vendor_file(file)


def zipped(path, *names):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, "1\t2\t3\n" * 50)
    return path


@pytest.mark.parametrize(
    ("write", "kind"),
    [
        (lambda path: zipped(path, "a.txt", "b.txt"), "a zip archive"),
        (lambda path: zipped(path, "[Content_Types].xml", "word/document.xml"), "a zip archive"),
        (lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(500)), "an HDF5 file"),
        (lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n" + b"Micromaterials2hdf.cwl"), "an HDF5 file"),
    ],
)
@pytest.mark.parametrize("columns", [None, ColumnMap({"time": "1", "load": "2", "depth": "3"})])
def test_an_unknown_container_is_of_no_format(tmp_path, write, kind, columns):
    write(tmp_path / "x.bin")
    with pytest.raises(InputError, match=f"is of no format that palpate knows: {kind}; unpack it, or export its tests"):
        read_vendor_file(tmp_path / "x.bin", columns=columns)
    assert main(["read", str(tmp_path / "x.bin"), "-o", str(tmp_path)]) == 2


def test_a_damaged_workbook_is_called_one(tmp_path):
    zipped(tmp_path / "x.xlsx", "[Content_Types].xml", "xl/workbook.xml", "xl/worksheets/sheet1.xml")
    for size in (-1, 200):
        (tmp_path / "y.xlsx").write_bytes((tmp_path / "x.xlsx").read_bytes()[:size])
        with pytest.raises(InputError, match="is no whole Excel workbook"):
            read_vendor_file(tmp_path / "y.xlsx")


@pytest.mark.parametrize("begin", [rb"\*Force file list", rb"\*File list", rb"\*force FILE list", b"?*File list"])
def test_a_nanoscope_file_is_called_one(tmp_path, begin):
    (tmp_path / "x.000").write_bytes(begin + b"\r\n\\Version: 0x09400103\r\n" + bytes(100))
    with pytest.raises(InputError, match="palpate knows: a NanoScope file, which the library afmformats does not read"):
        read_vendor_file(tmp_path / "x.000")
    with pytest.raises(InputError, match="palpate knows: a NanoScope file"):
        read_vendor_file(tmp_path / "x.000", columns=ColumnMap({"time": "1", "load": "2", "depth": "3"}))


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b"TDSm" + bytes(range(256)) * 9, "a TDMS file; export its tests as text"),
        (b"II*\0" + bytes(range(256)) * 9, "a TIFF image; export"),
        (b"[DataSet]\r\nVersion=2\r\n#!" + bytes(range(256)) * 9, "a Nanosurf file; export"),
        (bytes(range(256)) * 9, "a binary file; export its tests as text"),
        (b'<?xml version="1.0" ?>\n<Workbook/>', "an XML file; save it as a workbook"),
        (
            b'<?xml version="1.0" ?>\n<usi:tdm version="1.0"></usi:tdm>',
            "the header of a TDM file, whose numbers lie in",
        ),
        (b"\xef\xbb\xbf\r\n<HTML><table></table></HTML>", "an HTML page; save it as a workbook"),
    ],
)
@pytest.mark.parametrize("columns", [None, ColumnMap({"time": "1", "load": "2", "depth": "3"})])
def test_what_is_neither_text_nor_a_workbook_is_called_by_its_kind(tmp_path, content, kind, columns):
    (tmp_path / "x.dat").write_bytes(content)
    with pytest.raises(InputError, match=f"is of no format that palpate knows: {kind}"):
        read_vendor_file(tmp_path / "x.dat", columns=columns)


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16", "utf-16-le", "utf-16-be", "iso2022_jp"])
def test_a_text_in_any_encoding_is_no_binary_file(tmp_path, encoding):
    rows = "".join(f"{k}\t{k}\t{k}\n" for k in range(50))
    (tmp_path / "x.txt").write_bytes(("s\tmN\tnm\n" + rows).encode(encoding) + bytes(64))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=ColumnMap({"time": "1", "load": "2", "depth": "3"}))
    assert test.recording.load.max() == 49.0
