"""Jobs of the workflow leave a log, and end with one line where palpate refuses."""

import pytest

from palpate.errors import InputError
from palpate.workflow_support import job


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


def test_a_defect_keeps_its_traceback(log):
    with pytest.raises(ZeroDivisionError), job.logged(log):
        raise ZeroDivisionError
    assert "Traceback" in log.read_text()


def test_a_study_keeps_its_own_keys_that_are_called_like_those_of_the_command_line():
    diagnosis = {"reference": {"youngs_modulus": "7.2e1", "area": [24.5, 1e3]}}
    given = {"study": "glass", "quick": 1, "reference": "curves", "data": "files", "diagnosis": diagnosis}
    assert job.plain(given) == {
        "study": "glass",
        "diagnosis": {"reference": {"youngs_modulus": 72.0, "area": [24.5, 1000.0]}},
    }
    assert job.plain({**given, "source": {}})["data"] == "files"
