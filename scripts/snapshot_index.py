"""Write the table of all snapshots of a study."""

from palpate import job, snapshots


def main(snakemake):
    snapshots.index(snakemake.input).to_csv(snakemake.output[0], index=False)


if "snakemake" in globals():
    job.run(main, snakemake)  # noqa: F821
