"""Convert the tests of a vendor's file into the recordings of a study."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.inference.study_recordings import convert_source
from palpate.workflow_support import job


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    convert_source(study, Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
