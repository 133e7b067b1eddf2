"""Join the tables of all batches of snapshots.

input: tables of the batches (CSV). output: one table (CSV).
"""

import pandas as pd

from palpate.workflow_support import job


def main(snakemake):
    pd.concat(map(pd.read_csv, snakemake.input), ignore_index=True).to_csv(snakemake.output[0], index=False)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
