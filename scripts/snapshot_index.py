"""Join the tables of all batches of snapshots, without their curves.

input: curves of the batches (Parquet). output: one table (CSV).
"""

import pandas as pd

from palpate.solver.store import CURVES
from palpate.workflow_support import job


def main(snakemake):
    tables = [pd.read_parquet(file).drop(columns=list(CURVES)) for file in snakemake.input]
    pd.concat(tables, ignore_index=True).to_csv(snakemake.output[0], index=False)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
