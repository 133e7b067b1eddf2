"""The page on a vendor's file as it was read, and surveys of recordings that hold little or nothing."""

import numpy as np
import pytest
import yaml
from public_files import ANON, needs_recordings

from indentation_files.readers import locate, read_source, read_vendor_file
from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from indentation_files.survey import survey
from palpate.configuration import study_file
from palpate.configuration.study_file import load_study
from palpate.data import study_recordings
from palpate.data.study_recordings import convert_source
from palpate.errors import InputError
from palpate.output.recordings_page import write_reading

STUDY = {
    "study": "glass",
    "material": {"model": "elastic", "poisson_ratio": 0.2},
    "parameters": {"youngs_modulus": [60, 80]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "A", "load_history": "recorded"}],
    "recordings": {"lab": "results/glass/recordings/lab"},
}


def workbook_like(folder, contact):
    """A table of one test with 30 nm of approach, and the study that reads it."""
    time = np.linspace(0, 50, 501)
    depth = np.interp(time, [0, 10, 30, 50], [-30, 0, 200, 60])
    load = 8e-5 * np.clip(depth, 0, None) ** 2 * np.where(time > 30, np.interp(time, [30, 50], [1, 0]), 1)
    load += 2e-4 * np.sin(np.arange(501) ** 2)
    file = folder / "glass.csv"
    np.savetxt(file, np.column_stack([time, load, depth]), delimiter=",", header="t,P,h", comments="")
    source = {
        "file": str(file), "recordings": "lab", "conditions": {"A": [1]}, "contact": contact,
        "columns": {"time": "t", "load": "P", "depth": "h"},
    }  # fmt: skip
    (folder / "study.yaml").write_text(yaml.safe_dump({**STUDY, "source": source}))
    return folder / "study.yaml"


@pytest.mark.parametrize("contact", ["auto", 2.5])
def test_page_on_the_recordings_of_a_study(tmp_path, contact):
    study = load_study(workbook_like(tmp_path, contact))
    assert study.condition("A").protocol.sample_time[-1] == pytest.approx(40, abs=0.5)
    write_reading(study, tmp_path / "reading")
    page = (tmp_path / "reading/reading.html").read_text()
    assert page.count("<img") == 1
    assert "approach 0 to" in page
    rows = (tmp_path / "reading/survey.csv").read_text().splitlines()
    assert len(rows) == 2
    assert float(rows[1].split(",")[4]) == pytest.approx(0, abs=3), "contact in the file's own counting"


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("conditions", {"A": [1], "C": [1]}, "'C' is not among A"),
        ("conditions", {"A": [7]}, "has no test '7'"),
        ("conditions", {"A": [1, "glass"]}, "glass is test 'glass', which counts in A already"),
        ("contact", "automatic", "give file, auto or the depth"),
        ("contact", 1e4, "outside the way in"),
        ("corrections", ["creep"], '"creep" is given, expected one of: drift, frame'),
        ("condition", "A", "either condition or conditions"),
        ("columns", {"time": "t", "load": "P", "depth": "x"}, "no table with numbers"),
        ("units", {"load": "klb"}, "load in 'klb' is not known"),
    ],
)
def test_a_wrong_source_gets_one_line(tmp_path, key, value, words):
    path = workbook_like(tmp_path, "auto")
    values = yaml.safe_load(path.read_text())
    values["source"][key] = value
    path.write_text(yaml.safe_dump(values))
    with pytest.raises(InputError, match=words):
        load_study(path)


def test_units_of_a_source_without_columns_are_refused(tmp_path):
    path = workbook_like(tmp_path, "auto")
    values = yaml.safe_load(path.read_text())
    del values["source"]["columns"]
    path.write_text(yaml.safe_dump({**values, "source": values["source"] | {"units": {"load": "uN"}}}))
    with pytest.raises(InputError, match=r"source\.units: units are given without columns"):
        load_study(path)


def test_rows_that_were_left_out_are_told_on_the_page_and_in_the_recordings(tmp_path):
    path, file = workbook_like(tmp_path, "auto"), tmp_path / "glass.csv"
    file.write_text(file.read_text() + "51,broken,1\n")
    study = load_study(path)
    write_reading(study, tmp_path / "reading")
    said = "1 of 502 rows left out: no three numbers (line 503)"
    assert (tmp_path / "reading/reading.html").read_text().count(said) == 1
    convert_source(study, tmp_path / "converted")
    assert said in read_recording(tmp_path / "converted/A_1.csv").notes


def test_the_vendors_file_of_a_study_is_read_once(tmp_path, monkeypatch):
    read = []
    monkeypatch.setattr(study_file, "read_source", lambda source: read.append(source) or read_source(source))
    study = load_study(workbook_like(tmp_path, "auto"))
    study_recordings.check_given(study)
    assert study_recordings.tests_to_come(study, "lab") == {"A": 1}
    assert len(read) == 1


def test_a_study_without_a_source_has_no_such_page(tmp_path):
    path = workbook_like(tmp_path, "auto")
    values = yaml.safe_load(path.read_text())
    del values["source"]
    values["conditions"] = [{"name": "A", "max_load": 1, "loading_time": 1, "unloading_time": 1}]
    path.write_text(yaml.safe_dump(values))
    with pytest.raises(InputError, match="names no vendor's file"):
        write_reading(load_study(path), tmp_path)


@pytest.mark.parametrize("size", [3, 12, 50, 400])
@pytest.mark.parametrize("load", ["none", "constant", "noise", "falling", "ramp", "step"])
def test_strange_recordings_are_surveyed_or_refused(size, load):
    time, rng = np.linspace(0, 10, size), np.random.default_rng(0)
    force = {
        "none": 0 * time, "constant": 0 * time + 1, "noise": rng.standard_normal(size), "falling": 10 - time,
        "ramp": time, "step": 1.0 * (time > 5),
    }[load]  # fmt: skip
    try:
        found = survey(Recording(time, force, 100 * time))
    except InputError:
        return
    assert found.parts[0].start == 0
    assert found.parts[-1].end == 10
    assert found.contact.lower <= found.contact.depth <= found.contact.upper


@needs_recordings
def test_contact_of_a_recording_without_approach_is_near_its_start():
    (test,) = read_vendor_file(ANON, contact="none")
    found = survey(test.recording)
    assert found.contact.lower <= 0 <= found.contact.upper
    assert [part.kind for part in found.parts] == ["loading", "hold", "unloading"]
    assert [part.duration for part in found.parts] == pytest.approx([34.4, 30, 33], abs=0.5)


@pytest.mark.parametrize(
    ("files", "named", "found"),
    [
        (["A/x.txt", "B/x.txt"], "B/x.txt", "B/x.txt"),
        (["A/x.txt", "deep/B/x.txt"], "B/x.txt", "deep/B/x.txt"),
        (["x.txt", "B/x.txt"], "x.txt", "x.txt"),
        (["A/x.txt"], "B/x.txt", "A/x.txt"),
        (["A/x[1].txt"], "x[1].txt", "A/x[1].txt"),
        ([], "B/x.txt", "x.txt"),
        (["A/x.txt", "B/x.txt"], "x.txt", None),
        (["A/x.txt", "B/x.txt"], "C/x.txt", None),
    ],
)
def test_a_file_below_the_folder_of_data_is_found_by_its_path(tmp_path, files, named, found):
    for file in files:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text("x")
    if found is None:
        with pytest.raises(InputError, match=r"source\.file: .*x\.txt may be .*A/x\.txt or .*B/x\.txt; give its path"):
            locate(named, str(tmp_path))
    else:
        assert locate(named, str(tmp_path)) == str(tmp_path / found)


@pytest.mark.parametrize("conditions", [{"A": [1, "glass", "1"]}, {"A": [1], "B": ["glass"]}])
def test_a_test_counts_once(tmp_path, conditions):
    workbook_like(tmp_path, "auto")
    columns = {"time": "t", "load": "P", "depth": "h"}
    with pytest.raises(InputError, match="glass is test 'glass', which counts in A already; name each test once"):
        read_source({"file": str(tmp_path / "glass.csv"), "columns": columns, "conditions": conditions})
