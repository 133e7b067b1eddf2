"""Jobs of the workflow leave a log, and end with one line where palpate refuses."""

import errno
import os
import re
from pathlib import Path

import pytest

from palpate.errors import InputError
from palpate.workflow_support import job, result_files


@pytest.fixture
def log(tmp_path):
    return tmp_path / "job.log"


def test_the_log_tells_when_a_job_is_done(log):
    with job.logged(log):
        log.write_text("generation 1\n")
    first, last = log.read_text().splitlines()
    assert first == "generation 1"
    assert last.startswith("done in ")


def test_what_is_refused_is_one_line(log):
    with pytest.raises(SystemExit, match=r"^palpate: a.csv: is empty; copy it again$"), job.logged(log):
        raise InputError("is empty", remedy="copy it again", file="a.csv")
    assert log.read_text() == "palpate: a.csv: is empty; copy it again\n"


@pytest.mark.faults(before="a traceback")
@pytest.mark.parametrize(
    ("error", "line"),
    [
        (
            OSError(errno.ENOSPC, "No space left on device", "a.csv"),
            "a.csv: No space left on device; free space on the disk",
        ),
        (
            IsADirectoryError(errno.EISDIR, "Is a directory", "a"),
            "a: Is a directory; check the path and its permissions",
        ),
        (MemoryError(), "the memory does not suffice; use smaller files or fewer levels"),
    ],
)
def test_what_the_system_refuses_is_one_line(log, error, line):
    with pytest.raises(SystemExit, match=re.escape(line)), job.logged(log):
        raise error
    assert log.read_text() == f"palpate: {line}\n"


@pytest.mark.faults(before="a traceback")
def test_a_log_that_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(SystemExit, match="Is a directory"), job.logged(tmp_path):
        pass


def test_a_result_that_was_altered_is_refused_in_one_line_that_names_it_and_the_ways_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    logs, results = Path("results/s/logs"), [Path(f"results/s/{name}.json") for name in ("a", "b", "c")]
    logs.mkdir(parents=True)
    for number, file in enumerate(results):
        with job.logged(logs / f"job_{number}.log", [str(file)], f"rule_{number}"):
            file.write_text("1.0")
    result_files.refuse_altered(logs)
    results[0].write_text("1.1")
    results[1].unlink()
    line = "results/s/a.json: is not as its job made it; delete it, or make all again with --forcerun rule_0"
    with pytest.raises(InputError, match=f"^{line}$"):
        result_files.refuse_altered(logs)
    results[2].write_text("1.1")
    line = "are not as their jobs made them; delete them, or make all again with --forcerun rule_0 rule_2"
    with pytest.raises(InputError, match=f"^results/s/a.json, results/s/c.json: {line}$"):
        result_files.refuse_altered(logs, ["--force", "-nR", "rule_1"])
    assert [file.is_file() for file in results] == [True, False, True]


@pytest.mark.parametrize(
    "given", [["-F"], ["-R", "job", "-n"], ["--forcerun", "results/s/a.json", "--cores", "2", "--", "all"]]
)
def test_a_result_that_was_altered_is_accepted_where_it_is_made_again(tmp_path, monkeypatch, given):
    monkeypatch.chdir(tmp_path)
    logs, file = Path("results/s/logs"), Path("results/s/a.json")
    logs.mkdir(parents=True)
    with job.logged(logs / "job.log", [str(file)], "job"):
        file.write_text("1.0")
    file.write_text("1.1")
    assert result_files.altered(logs) == [(file, "job")]
    result_files.refuse_altered(logs, given)


def test_a_result_that_a_job_is_replacing_is_not_altered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    logs, file = Path("results/s/logs"), Path("results/s/a.json")
    logs.mkdir(parents=True)
    for text in ("1", "2"):
        with job.logged(logs / "job.log", [str(file)]):
            file.write_text(text)
            assert result_files.altered(logs) == []


def test_a_result_counts_as_the_later_of_two_logs_knows_it(tmp_path, monkeypatch):
    """Logs may have had other names when it was made first."""
    monkeypatch.chdir(tmp_path)
    logs, file = Path("results/s/logs"), Path("results/s/a.json")
    (logs / "fit").mkdir(parents=True)
    for name in ("job.log", "fit/job.log"):
        with job.logged(logs / name, [str(file)]):
            file.write_text(name)
    os.utime(logs / "job.sha256", (0, 0))
    assert result_files.altered(logs) == []


@pytest.mark.parametrize(
    ("value", "meant"), [(None, False), ("false", False), (False, False), (0, False), ("True", True), (1, True)]
)
def test_what_the_command_line_gives_as_text_is_true_or_false(value, meant):
    assert job.boolean("quick", value) is meant


@pytest.mark.parametrize("value", ["no", "", 2])
def test_what_is_neither_true_nor_false_is_refused(value):
    with pytest.raises(InputError, match=f"quick={value} is neither true nor false; give quick=true or quick=false"):
        job.boolean("quick", value)


def test_a_defect_keeps_its_traceback(log):
    with pytest.raises(ZeroDivisionError), job.logged(log):
        raise ZeroDivisionError
    assert "Traceback" in log.read_text()


def test_a_study_keeps_its_own_keys_that_are_called_like_those_of_the_command_line():
    diagnosis = {"reference": {"youngs_modulus": 72.0}}
    given = {"study": "1e5", "quick": 1, "reference": "curves", "data": "files", "diagnosis": diagnosis}
    assert job.plain(given) == {"study": "1e5", "diagnosis": diagnosis}
    assert job.plain({**given, "source": {}})["data"] == "files"
