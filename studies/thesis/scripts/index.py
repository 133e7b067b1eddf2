"""Write the page of all studies of the thesis, with verdicts."""

import datetime
import os
from pathlib import Path

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies import thesis
from studies.thesis import index


def main(snakemake):
    outcomes = {Path(file).stem: read_json(file) for file in snakemake.input.outcomes}
    figures = {Path(file).stem: file for file in snakemake.input.figures}
    curves = [thesis.Curves.load_from(file) for file in snakemake.input.designs]
    began = datetime.datetime.fromisoformat(os.environ["PALPATE_EXECUTION"])
    made = [*snakemake.input.outcomes, *snakemake.input.designs]
    wall = index.elapsed(began, datetime.datetime.now(), made)
    index.write(outcomes, figures, curves, snakemake.output[0], wall)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
