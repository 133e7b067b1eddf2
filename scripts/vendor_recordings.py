"""Convert the tests of a vendor's file into the recordings of a study.

input: the vendor's file. output: recordings (CSV), all in one folder. settings: `source`.
"""

from pathlib import Path

from palpate.data.study_recordings import convert_source
from palpate.workflow_support import job


def main(snakemake):
    convert_source(job.study(snakemake), Path(snakemake.output[0]).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
