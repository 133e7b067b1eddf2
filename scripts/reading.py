"""Write the page on a study's recordings as they were read."""

from pathlib import Path

from palpate import job
from palpate.config import load_study
from palpate.reading import write_reading


def main(snakemake):
    study = load_study(snakemake.input.study, data=snakemake.params.data)
    write_reading(study, Path(snakemake.output.page).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
