"""Draw the figure of one study of the thesis from its saved outcome."""

import importlib

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json


def main(snakemake):
    figure = importlib.import_module(f"studies.thesis.figures.{snakemake.wildcards.key}")
    figure.draw(read_json(snakemake.input[0]), snakemake.output[0])


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
