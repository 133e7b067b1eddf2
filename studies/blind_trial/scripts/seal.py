"""Draw all cases, seal the truth, and print its checksum before anything is diagnosed."""

from pathlib import Path

from palpate.workflow_support import job
from studies.blind_trial.cases import draw, seal


def main(snakemake):
    study = job.study(snakemake)
    checksum = seal(draw(study), Path(snakemake.output.truth))
    Path(snakemake.output.checksum).write_text(f"{checksum}  sealed.json\n", encoding="utf-8")
    print(f"the truth is sealed; SHA-256 {checksum}")


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
