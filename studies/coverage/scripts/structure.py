"""Compare structures of a law's discrepancy on creep that no trial reports."""

from palpate.workflow_support import job
from studies.coverage.structure import tables


def main(snakemake):
    structures, moduli = tables()
    structures.to_csv(snakemake.output.structures)
    moduli.to_csv(snakemake.output.moduli, index=False)
    print(structures.to_string(float_format="{:.1f}".format))
    print(moduli.describe(percentiles=[0.1, 0.5, 0.9]).to_string(float_format="{:.4f}".format))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
