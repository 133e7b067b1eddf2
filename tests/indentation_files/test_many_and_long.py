"""What is long or many is read once, by columns, and no more of it kept than counts."""

import argparse

import numpy as np
import pytest
import yaml

from indentation_files import recording_file
from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from palpate.cli import check
from palpate.configuration.study_file import study_from
from palpate.data import study_recordings
from palpate.errors import InputError
from palpate.solver import store

STUDY = {
    "study": "many",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [2.0, 2.5, 3.0, 3.5]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}],
    "recordings": {"lab": "lab"},
}


def test(points):
    time = np.linspace(0.0, 60.0, points)
    load = np.interp(time, [0.0, 30.0, 60.0], [0.0, 1.0, 0.0])
    return Recording(time, load, 500.0 * np.sqrt(load))


test.__test__ = False


def test_check_reads_every_recording_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").mkdir()
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    for number in range(1, 6):
        test(50 + number).write(tmp_path / f"lab/A_{number}.csv")
    read = []
    monkeypatch.setattr(study_recordings, "read_recording", lambda file: read.append(file) or read_recording(file))
    assert check.run(argparse.Namespace(study=tmp_path / "study.yaml", data=None)) == 0
    assert len(read) == len(set(read)) == 5
    assert "5 of A" in capsys.readouterr().out


@pytest.mark.parametrize(("given", "most"), [({}, 400), ({"cells_per_job": 1000}, 100)])
def test_a_hundred_thousand_snapshots_are_a_few_hundred_jobs(tmp_path, given, most):
    levels = {
        name: list(np.linspace(*ends, 29)) for name, ends in (("youngs_modulus", (2, 4)), ("yield_stress", (1, 2)))
    }
    levels["hardening"] = list(np.linspace(0.0, 1.0, 30))
    conditions = [{"name": f"T{k}", "max_load": 1.0, "loading_time": 30, "unloading_time": 30 + k} for k in range(4)]
    law = {"material": {"model": "bilinear_plasticity", "poisson_ratio": 0.3}, "parameters": levels}
    plan = store.plan(study_from(STUDY | law | {"conditions": conditions, "recordings": {}} | given, "study.yaml"))
    sizes = [len(batch.cells) * len(batch.conditions) for batch in plan]
    assert sum(sizes) == 4 * 29 * 29 * 30
    assert len(plan) <= most + len(conditions)
    assert len({batch.name for batch in plan}) == len(plan)


def test_files_read_by_columns_and_line_by_line_hold_the_same(tmp_path):
    for points in (3, 300, 3000):
        whole, commented = tmp_path / f"a_{points}.csv", tmp_path / f"b_{points}.csv"
        test(points).write(whole)
        commented.write_text(whole.read_text() + "# a comment, which no reader of columns accepts\n")
        for channel in ("time", "load", "depth"):
            assert np.array_equal(*(getattr(read_recording(file), channel) for file in (whole, commented)))


@pytest.mark.parametrize("points", [9999, 10_000, 10_001])
def test_of_a_long_recording_evenly_spaced_points_and_the_last_are_kept(tmp_path, monkeypatch, points):
    monkeypatch.setattr(recording_file, "MOST", 1000)
    monkeypatch.setattr(recording_file, "BLOCK", 1 << 15)  # bytes, so that it is read in several blocks
    test(points).write(tmp_path / "a_1.csv")
    found, times = read_recording(tmp_path / "a_1.csv"), np.linspace(0.0, 60.0, points)
    every = -(-points // 1000)
    expected = np.union1d(times[::every], times[-1:])
    assert found.time == pytest.approx(expected, rel=1e-8)
    assert len(found) <= 1001


def test_a_point_of_a_long_recording_that_is_not_kept_is_checked_as_well(tmp_path, monkeypatch):
    monkeypatch.setattr(recording_file, "MOST", 1000)
    monkeypatch.setattr(recording_file, "BLOCK", 1 << 15)
    test(10_000).write(tmp_path / "a_1.csv")
    lines = (tmp_path / "a_1.csv").read_text().splitlines()
    for line, wrong in ((7778, "nan"), (7777, lines[7000].split(",")[0])):
        cells = lines[line].split(",")
        (tmp_path / "b_1.csv").write_text("\n".join([*lines[:line], ",".join([wrong, *cells[1:]]), *lines[line + 1 :]]))
        with pytest.raises(InputError, match=f"b_1.csv.* point {line}"):
            read_recording(tmp_path / "b_1.csv")


def test_a_single_point_below_long_comments_is_read_without_a_last_line_break(tmp_path):
    (tmp_path / "a_1.csv").write_text("# a comment\n" * 3000 + "time_s,load_mN,depth_nm\n1,2,3")
    found = read_recording(tmp_path / "a_1.csv")
    assert (found.time, found.load, found.depth) == ([1.0], [2.0], [3.0])
