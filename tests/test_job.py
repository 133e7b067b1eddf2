"""Jobs of the workflow leave a log, and end with one line where palpate refuses."""

from types import SimpleNamespace

import pytest

from palpate import job
from palpate.errors import InputError


@pytest.fixture
def snakemake(tmp_path):
    return SimpleNamespace(log=[str(tmp_path / "job.log")])


def log_of(snakemake):
    with open(snakemake.log[0], encoding="utf-8") as log:
        return log.read()


def test_the_log_tells_when_a_job_is_done(snakemake):
    def main(snakemake):
        with open(snakemake.log[0], "w", encoding="utf-8") as log:
            print("generation 1", file=log)

    job.run(main, snakemake)
    first, last = log_of(snakemake).splitlines()
    assert first == "generation 1"
    assert last.startswith("done in ")


def test_what_is_refused_is_one_line(snakemake):
    def main(snakemake):
        raise InputError("is empty", remedy="copy it again", file="a.csv")

    with pytest.raises(SystemExit, match=r"^palpate: a.csv: is empty; copy it again$"):
        job.run(main, snakemake)
    assert log_of(snakemake) == "palpate: a.csv: is empty; copy it again\n"


def test_a_defect_keeps_its_traceback(snakemake):
    def main(snakemake):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        job.run(main, snakemake)
    assert "in main" in log_of(snakemake)
