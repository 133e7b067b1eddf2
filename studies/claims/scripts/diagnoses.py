"""Diagnose a group of sets with a study's settings."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json
from studies.claims.diagnoses import diagnosed
from studies.claims.sets import Case


def main(snakemake):
    study, rows = load_study(Path(snakemake.input.study)), []
    for values in read_json(snakemake.input.truth):
        rows.append(diagnosed(Case(**values), study))
        job.note(snakemake.log[0], values["name"])
    write_json(snakemake.output[0], rows)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
