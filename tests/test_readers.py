"""Vendors' files against facts that their makers printed in them; foreign and broken files against one clear line."""

from pathlib import Path

import numpy as np
import pytest

from palpate.cli import main
from palpate.errors import InputError
from palpate.readers import READERS, read_vendor_file, select
from palpate.recording import read_recording

RECORDINGS = Path(__file__).parent.parent.parent / "shared/recordings"
needs_recordings = pytest.mark.skipif(
    not RECORDINGS.is_dir(), reason="the public recordings are not part of the repository (folder shared/recordings)"
)
ANON = RECORDINGS / "indentationTools.jl/anonNI.TXT"
LONG = RECORDINGS / "gukin94/HT_V_300mN.TXT"


@needs_recordings
def test_anton_paar_agrees_with_its_own_header():
    (test,) = read_vendor_file(ANON)
    assert test.recording.load.max() == pytest.approx(11.13, abs=0.005)
    hold_end = test.recording.depth[np.flatnonzero(test.recording.load > 11.1)[-1]]
    assert hold_end == pytest.approx(2110.86, abs=3.0)
    assert test.metadata["EIT"].startswith("2,5187")
    duration = test.recording.time[-1]
    assert 90 < duration < 110


@needs_recordings
def test_several_tests_side_by_side():
    tests = read_vendor_file(LONG)
    assert [test.name for test in tests] == [f"HT_V_300mN_{k}" for k in (1, 2, 3, 4)]
    for test in tests:
        assert test.recording.load.max() == pytest.approx(300, rel=0.01)
        hold = test.recording.load > 0.99 * 300
        assert np.ptp(test.recording.time[hold]) == pytest.approx(500, abs=10)
    assert select(tests, "2", LONG).name == "HT_V_300mN_2"
    with pytest.raises(InputError, match="no test"):
        select(tests, "9", LONG)


@needs_recordings
def test_read_writes_recordings(tmp_path):
    assert main(["read", str(ANON), "-o", str(tmp_path)]) == 0
    recording = read_recording(tmp_path / "anonNI.csv")
    assert recording.load.max() == pytest.approx(11.13, abs=0.005)
    assert any("EIT" in note for note in recording.notes)


@needs_recordings
@pytest.mark.parametrize(
    ("source", "spoil", "words"),
    [
        (ANON, lambda text: text[:800], "column line"),
        (ANON, lambda text: text[:2400].rsplit("\t", 2)[0], "cut off"),
        (ANON, lambda text: text.replace("0,1948", "abc"), "not a row of numbers"),
        (LONG, lambda text: text.split("\n")[0] + "\n", "no measured values"),
    ],
)
def test_broken_files_get_one_line(tmp_path, source, spoil, words, capsys):
    file = tmp_path / "x.TXT"
    file.write_text(spoil(source.read_text(encoding="latin-1")), encoding="latin-1")
    assert main(["read", str(file), "-o", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err.strip()
    assert words in line
    assert str(file) in line
    assert "\n" not in line


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n", b"hello world\n1,2,3\n"])
def test_foreign_files_get_one_line(tmp_path, content, capsys):
    file = tmp_path / "x.TXT"
    file.write_bytes(content)
    assert main(["read", str(file), "-o", str(tmp_path / "out")]) == 2
    assert "no format that palpate knows" in capsys.readouterr().err


def test_checksum_guards_a_study(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time_s,load_mN,depth_nm\n0,0,0\n1,1,1\n")
    assert len(read_vendor_file(file)) == 1
    with pytest.raises(InputError, match="sha256"):
        read_vendor_file(file, "0" * 64)


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_readers_match_nothing_empty(reader):
    assert not reader.matches(b"")
    assert reader.title
