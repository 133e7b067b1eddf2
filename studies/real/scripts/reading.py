"""Write the page on a study's recordings as they were read."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.output.recordings_page import write_reading
from palpate.workflow_support import job


def main(snakemake):
    study = load_study(snakemake.input.study, data=snakemake.params.data)
    write_reading(study, Path(snakemake.output.page).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
