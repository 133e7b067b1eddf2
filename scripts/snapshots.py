"""Compute one batch of snapshots, or fetch them from the store."""

from palpate.configuration.study_file import load_study
from palpate.solver import store
from palpate.workflow_support import job


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    batch = next(batch for batch in store.plan(study) if batch.name == snakemake.params.batch)
    with open(snakemake.log[0], "w", encoding="utf-8") as log:
        store.compute(batch, report=lambda line: print(line, file=log, flush=True))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
