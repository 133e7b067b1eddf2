"""Write the synthetic recordings of one material of the thesis."""

from pathlib import Path

from palpate import job, laboratory
from palpate.config import load_study


def main(snakemake):
    laboratory.write(load_study(snakemake.input[0]), "virtual", Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
