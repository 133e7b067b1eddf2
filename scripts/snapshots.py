"""Compute one batch of snapshots, or fetch them from the store.

output: the curves of the batch (Parquet), with address, condition, status, reason and parameters of each snapshot.
"""

import functools

from palpate.solver import store
from palpate.workflow_support import job


def main(snakemake):
    study = job.study(snakemake)
    batch = next(batch for batch in store.plan(study) if batch.name == snakemake.wildcards.batch)
    contents = store.computed(batch.snapshots, report=functools.partial(job.note, snakemake.log[0]))
    store.table(batch.snapshots, contents).to_parquet(snakemake.output[0], index=False)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
