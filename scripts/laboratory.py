"""Write the recordings of a virtual laboratory.

output: recordings (CSV), all in one folder, and the truth beside them (JSON). settings: `laboratory`.
"""

from pathlib import Path

from palpate.laboratory import virtual
from palpate.workflow_support import job


def main(snakemake):
    virtual.write(job.study(snakemake), snakemake.params.laboratory, Path(snakemake.output[0]).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
