"""Give the calibration on all conditions its short name.

input: the calibration (JSON). output: a copy.
"""

import shutil

from palpate.workflow_support import job


def main(snakemake):
    shutil.copyfile(snakemake.input[0], snakemake.output[0])


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
