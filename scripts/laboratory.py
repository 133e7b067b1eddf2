"""Write the recordings of a virtual laboratory."""

from pathlib import Path

from palpate import job, laboratory
from palpate.config import load_study


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    laboratory.write(study, snakemake.params.laboratory, Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
