"""Draw the figure of one study of the thesis from its saved outcome."""

import importlib

from palpate import job, steps


def main(snakemake):
    figure = importlib.import_module(f"palpate.figures.thesis_{snakemake.wildcards.key}")
    figure.draw(steps.read_json(snakemake.input[0]), snakemake.output[0])


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
