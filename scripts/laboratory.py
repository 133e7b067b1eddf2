"""Write the recordings of a virtual laboratory."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.laboratory import virtual
from palpate.workflow_support import job


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    virtual.write(study, snakemake.params.laboratory, Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
