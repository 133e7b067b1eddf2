"""Bring together the curves of one design of the thesis, from the store or from the solver."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies import thesis


def main(snakemake):
    studies = {Path(file).stem: load_study(file) for file in snakemake.input.studies}
    outcomes = {Path(file).stem: read_json(file) for file in snakemake.input.outcomes}
    runs = thesis.DESIGNS[snakemake.wildcards.design].runs(studies, outcomes)
    with open(snakemake.log[0], "w", encoding="utf-8") as log:
        curves = thesis.compute(runs, Path("results/store"), lambda line: print(line, file=log, flush=True))
    curves.save(snakemake.output[0])


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
