"""Write the table of all snapshots of a study."""

from palpate.solver import store
from palpate.workflow_support import job


def main(snakemake):
    store.index(snakemake.input).to_csv(snakemake.output[0], index=False)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
