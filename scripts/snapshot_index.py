"""Write the table of all snapshots of a study."""

from palpate import snapshots


def main(snakemake):
    snapshots.index(snakemake.input).to_csv(snakemake.output[0], index=False)


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
