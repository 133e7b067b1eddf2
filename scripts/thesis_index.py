"""Write the page of all studies of the thesis, with verdicts."""

from pathlib import Path

from palpate import steps, thesis
from palpate.thesis import index


def main(snakemake):
    outcomes = {Path(file).stem: steps.read_json(file) for file in snakemake.input.outcomes}
    figures = {Path(file).stem: file for file in snakemake.input.figures}
    curves = [thesis.Curves.load_from(file) for file in snakemake.input.designs]
    index.write(outcomes, figures, curves, snakemake.output[0])


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
