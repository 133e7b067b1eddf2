"""Write the synthetic recordings of one material of the thesis."""

from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.laboratory import virtual
from palpate.workflow_support import job


def main(snakemake):
    virtual.write(load_study(snakemake.input[0]), "virtual", Path(snakemake.output[0]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
