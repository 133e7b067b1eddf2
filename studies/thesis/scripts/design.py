"""Bring together the curves of one design of the thesis, from the store or from the solver."""

import functools
from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies import thesis


def main(snakemake):
    studies = {Path(file).stem: load_study(file) for file in snakemake.input.studies}
    outcomes = {Path(file).stem: read_json(file) for file in snakemake.input.outcomes}
    runs = thesis.DESIGNS[snakemake.wildcards.design].runs(studies, outcomes)
    curves = thesis.compute(runs, Path("results/store"), functools.partial(job.note, snakemake.log[0]))
    curves.save(snakemake.output[0])


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
