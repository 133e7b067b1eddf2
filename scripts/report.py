"""Write the study's report."""

from pathlib import Path

from palpate import job, steps
from palpate.config import load_study


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    steps.write_report(study, Path("results") / study.name, Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
