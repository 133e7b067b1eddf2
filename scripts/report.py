"""Write the study's report."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job, steps


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    steps.write_report(study, Path("results") / study.name, Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
