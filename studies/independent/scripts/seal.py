"""Draw all sets and seal the truth, before any of them is diagnosed."""

from pathlib import Path

from palpate.workflow_support import job
from studies.blind_trial.cases import seal
from studies.independent import DRAWS, SEED
from studies.independent.recordings import draw


def main(snakemake):
    checksum = seal(draw(SEED, DRAWS), Path(snakemake.output[0]))
    print(f"the truth is sealed; SHA-256 {checksum}")


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
