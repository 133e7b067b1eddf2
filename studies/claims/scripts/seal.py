"""Draw a group of sets and seal the truth, before any of them is diagnosed."""

from pathlib import Path

from palpate.workflow_support import job
from studies.claims import GROUP, SEED
from studies.claims.sets import draw
from studies.coverage.sets import seal


def main(snakemake):
    first = GROUP * int(snakemake.wildcards.group)
    checksum = seal(draw(range(first, first + GROUP), SEED), Path(snakemake.output[0]))
    print(f"the truth of {GROUP} sets is sealed; SHA-256 {checksum}")


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
